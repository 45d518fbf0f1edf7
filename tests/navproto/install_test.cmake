# Installs the component navproto into a folder of its own, builds the example against it alone, and runs it.
# cmake -DBUILD=... -DSOURCE=... -DGENERATOR=... -DCOMPILER=... -DFLAGS=... -P install_test.cmake
set(folder "${BUILD}/tests/navproto_install")
file(REMOVE_RECURSE "${folder}")

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run("${CMAKE_COMMAND}" --install "${BUILD}" --component navproto --prefix "${folder}/prefix")
file(GLOB_RECURSE headers RELATIVE "${folder}/prefix" "${folder}/prefix/include/*")
foreach(header IN LISTS headers)
  file(READ "${folder}/prefix/${header}" text)
  if(text MATCHES "zmq|flatbuffers|zstd\\.h")
    message(FATAL_ERROR "${header} shows what belongs inside the .cpp files")
  endif()
endforeach()

run("${CMAKE_COMMAND}" -S "${SOURCE}/navproto/examples/steer" -B "${folder}/build" -G "${GENERATOR}"
  "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_CXX_FLAGS=${FLAGS}" "-DCMAKE_PREFIX_PATH=${folder}/prefix")
run("${CMAKE_COMMAND}" --build "${folder}/build")
run("${folder}/build/steer" "ipc://${folder}/nobody" 2)
if(NOT output STREQUAL "x 0.000 m, y 0.000 m, heading 0.000 rad\nx 0.000 m, y 0.000 m, heading 0.000 rad\n")
  message(FATAL_ERROR "steer said: ${output}")
endif()
