# The component navproto works by itself: its example is built against an installation alone, and runs.
include("${SOURCE}/tests/support/install_component.cmake")
install_component(navproto navproto/examples/steer "zmq|flatbuffers|zstd\\.h")
run("${folder}/build/steer" "ipc://${folder}/nobody" 2)
if(NOT output STREQUAL "x 0.000 m, y 0.000 m, heading 0.000 rad\nx 0.000 m, y 0.000 m, heading 0.000 rad\n")
  message(FATAL_ERROR "steer said: ${output}")
endif()
