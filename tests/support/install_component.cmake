# install_component(COMPONENT EXAMPLE HIDDEN)
#   For a script run with -DBUILD=... -DSOURCE=... -DGENERATOR=... -DCOMPILER=... -DFLAGS=...: installs the component into
#   a folder of its own, fails where an installed header includes what matches HIDDEN, and builds the program of the
#   folder EXAMPLE against the installation alone. Sets `folder`; the program is in ${folder}/build.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(install_component component example hidden)
  set(folder "${BUILD}/tests/${component}_install")
  set(folder "${folder}" PARENT_SCOPE)
  file(REMOVE_RECURSE "${folder}")
  run("${CMAKE_COMMAND}" --install "${BUILD}" --component ${component} --prefix "${folder}/prefix")
  file(GLOB_RECURSE headers "${folder}/prefix/include/*")
  foreach(header IN LISTS headers)
    file(STRINGS "${header}" shown REGEX "#include.*(${hidden})")
    if(shown)
      message(FATAL_ERROR "${header} shows what belongs inside the .cpp files: ${shown}")
    endif()
  endforeach()
  build_example("${example}" "${folder}/build")
endfunction()

# build_example(EXAMPLE BUILD)
#   Builds the program of another folder against the same installation, in the folder BUILD.
function(build_example example build)
  run("${CMAKE_COMMAND}" -S "${SOURCE}/${example}" -B "${build}" -G "${GENERATOR}"
    "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_CXX_FLAGS=${FLAGS}" "-DCMAKE_PREFIX_PATH=${folder}/prefix")
  run("${CMAKE_COMMAND}" --build "${build}")
endfunction()
