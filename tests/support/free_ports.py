"""TCP ports of this machine that nobody has."""
import socket


def four_free_ports():
    """The first of four ports in a row, as an endpoint of the daemon takes them."""
    while True:
        with socket.create_server(("127.0.0.1", 0)) as first:
            port = first.getsockname()[1]
            try:
                for other in range(port + 1, port + 4):
                    socket.create_server(("127.0.0.1", other)).close()
                return port
            except (OSError, OverflowError):
                continue
