"""Hands at a window of an X display: keys, and files that are dropped. Of libX11 and libXtst by ctypes."""
import ctypes
import time

CLIENT_MESSAGE, SELECTION_NOTIFY, SELECTION_REQUEST = 33, 31, 30
NAMES = {".": "period", "-": "minus", "/": "slash", "\n": "Return", " ": "space"}


class ClientMessage(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", ctypes.c_ulong), ("message_type", ctypes.c_ulong),
                ("format", ctypes.c_int), ("data", ctypes.c_long * 5)]


class SelectionRequest(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("owner", ctypes.c_ulong), ("requestor", ctypes.c_ulong),
                ("selection", ctypes.c_ulong), ("target", ctypes.c_ulong), ("property", ctypes.c_ulong),
                ("time", ctypes.c_ulong)]


class Selection(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("requestor", ctypes.c_ulong), ("selection", ctypes.c_ulong),
                ("target", ctypes.c_ulong), ("property", ctypes.c_ulong), ("time", ctypes.c_ulong)]


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("message", ClientMessage), ("request", SelectionRequest),
                ("selection", Selection), ("room", ctypes.c_long * 24)]


def load():
    """The libraries, or none where they are missing."""
    try:
        x, test = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
    except OSError:
        return None
    for name in ("XOpenDisplay", "XGetSelectionOwner"):
        getattr(x, name).restype = ctypes.c_void_p
    for name in ("XDefaultRootWindow", "XInternAtom", "XCreateSimpleWindow", "XStringToKeysym"):
        getattr(x, name).restype = ctypes.c_ulong
    return x, test


class Hands:
    """At the window with that title of the display of that name; waits for it."""

    def __init__(self, display, title, seconds=60):
        self.x, self.test = load()
        deadline = time.monotonic() + seconds
        self.display = self.window = None
        while not self.window:
            if time.monotonic() > deadline:
                raise TimeoutError(f"no window {title} on {display}")
            time.sleep(0.1)
            self.display = self.display or self.x.XOpenDisplay(display.encode())
            if self.display:
                self.display = ctypes.c_void_p(getattr(self.display, "value", self.display))
                self.root = ctypes.c_ulong(self.x.XDefaultRootWindow(self.display))
                self.window = self.find(title)

    def close(self):
        self.x.XCloseDisplay(self.display)

    def find(self, title):
        root, parent, count = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.c_uint()
        children = ctypes.POINTER(ctypes.c_ulong)()
        self.x.XQueryTree(self.display, self.root, ctypes.byref(root), ctypes.byref(parent), ctypes.byref(children),
                          ctypes.byref(count))
        for child in children[:count.value]:
            name = ctypes.c_char_p()
            if self.x.XFetchName(self.display, ctypes.c_ulong(child), ctypes.byref(name)) and name.value == title.encode():
                return ctypes.c_ulong(child)
        return None

    def atom(self, name):
        return self.x.XInternAtom(self.display, name.encode(), 0)

    def key(self, name, down):
        symbol = self.x.XStringToKeysym(name.encode())
        assert symbol != 0, f"no key is named {name}"
        code = self.x.XKeysymToKeycode(self.display, ctypes.c_ulong(symbol))
        self.test.XTestFakeKeyEvent(self.display, code, int(down), ctypes.c_ulong(0))
        self.x.XFlush(self.display)
        time.sleep(0.12)  # longer than a frame takes, which takes in one event of a key

    def press(self, *names):
        """Keys together: the first ones are held."""
        for name in names:
            self.key(name, True)
        for name in reversed(names):
            self.key(name, False)

    def type(self, text):
        for letter in text:
            self.press(NAMES.get(letter, letter))

    def point(self):
        """Keys go to the window under the pointer, where there is no window manager."""
        self.x.XWarpPointer(self.display, ctypes.c_ulong(0), self.root, 0, 0, 0, 0, 700, 400)
        self.x.XFlush(self.display)

    def tell(self, kind, *data):
        event = Event(message=ClientMessage(CLIENT_MESSAGE, 0, 1, self.display, self.window.value, self.atom(kind), 32,
                                            (ctypes.c_long * 5)(*data)))
        self.x.XSendEvent(self.display, self.window, 0, ctypes.c_long(0), ctypes.byref(event))
        self.x.XFlush(self.display)

    def ask_to_close(self):
        self.tell("WM_PROTOCOLS", self.atom("WM_DELETE_WINDOW"), 0)

    def drop(self, path, seconds=60):
        """A file onto the middle of the window, as a file manager does (XDND 5)."""
        source = self.x.XCreateSimpleWindow(self.display, self.root, 0, 0, 1, 1, 0, ctypes.c_ulong(0), ctypes.c_ulong(0))
        uris = self.atom("text/uri-list")
        self.x.XSetSelectionOwner(self.display, ctypes.c_ulong(self.atom("XdndSelection")), ctypes.c_ulong(source),
                                  ctypes.c_ulong(0))
        self.tell("XdndEnter", source, 5 << 24, uris, 0, 0)
        self.tell("XdndPosition", source, 0, 700 << 16 | 400, 0, self.atom("XdndActionCopy"))
        deadline, event = time.monotonic() + seconds, Event()
        while time.monotonic() < deadline:
            if not self.x.XPending(self.display):
                time.sleep(0.02)
                continue
            self.x.XNextEvent(self.display, ctypes.byref(event))
            if event.type == SELECTION_REQUEST:
                asked, text = event.request, f"file://{path}\r\n".encode()
                self.x.XChangeProperty(self.display, ctypes.c_ulong(asked.requestor), ctypes.c_ulong(asked.property),
                                       ctypes.c_ulong(asked.target), 8, 0, text, len(text))
                given = Event(selection=Selection(SELECTION_NOTIFY, 0, 1, self.display, asked.requestor, asked.selection,
                                                  asked.target, asked.property, asked.time))
                self.x.XSendEvent(self.display, ctypes.c_ulong(asked.requestor), 0, ctypes.c_long(0), ctypes.byref(given))
                self.x.XFlush(self.display)
            elif event.type == CLIENT_MESSAGE and event.message.message_type == self.atom("XdndStatus"):
                assert event.message.data[1] & 1, "the window takes no files"
                self.tell("XdndDrop", source, 0, 0, 0, 0)
            elif event.type == CLIENT_MESSAGE and event.message.message_type == self.atom("XdndFinished"):
                return
        raise TimeoutError("the window did not take the file")
