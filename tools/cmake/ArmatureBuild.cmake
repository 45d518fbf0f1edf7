# Settings that hold for every target, and the two functions that declare one.
include(GNUInstallDirs)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# The build tree has the shape of an installation: programs find what they need by relative path in both.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(ARMATURE_SHARE_DIR "${CMAKE_BINARY_DIR}/share/armature")
# What programs load when they need it.
set(ARMATURE_PLUGIN_DIR "lib/armature")
# OpenNI2 with our choice of drivers (firmware_host/CMakeLists.txt), found from bin/ and tests/ alike.
set(ARMATURE_OPENNI2_DIR "${ARMATURE_PLUGIN_DIR}/openni2")
set(CMAKE_BUILD_RPATH "$ORIGIN/../${ARMATURE_OPENNI2_DIR}")
set(CMAKE_INSTALL_RPATH "$ORIGIN/../${ARMATURE_OPENNI2_DIR}")

find_program(ARMATURE_CCACHE ccache)
if(ARMATURE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${ARMATURE_CCACHE}")
  set(CMAKE_C_COMPILER_LAUNCHER "${ARMATURE_CCACHE}")
endif()

# The same bytes on every machine: no contraction to FMA, no fast-math, no -march.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>)
if(ARMATURE_SANITIZE)
  add_compile_options(-fsanitize=${ARMATURE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${ARMATURE_SANITIZE})
endif()

if(ARMATURE_FUZZ)
  # Every module reports its branches to the fuzzer; the targets link it.
  add_compile_options(-fsanitize=fuzzer-no-link)
  add_custom_target(fuzzers COMMENT "Every libFuzzer target")
endif()

add_library(armature_warnings INTERFACE)
target_compile_options(armature_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wold-style-cast -Wcast-align
  -Wextra-semi)

# armature_module(NAME SOURCES a.cpp a.h... [PUBLIC lib...] [PRIVATE lib...])
#   Declares the static library armature_NAME, alias armature::NAME. Includes are written from the project's root.
function(armature_module name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(armature_${name} STATIC ${arg_SOURCES})
  add_library(armature::${name} ALIAS armature_${name})
  target_include_directories(armature_${name} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>")
  target_link_libraries(armature_${name} PUBLIC ${arg_PUBLIC} PRIVATE armature_warnings ${arg_PRIVATE})
endfunction()

# armature_test(NAME SOURCES a.cpp... LIBS lib...)
#   Declares the GoogleTest program NAME_test, one ctest entry a program. Tests run from the project's root. How long they
#   may take, and what sanitizers overlook, is said once, by the test presets.
function(armature_test name)
  cmake_parse_arguments(arg "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name}_test ${arg_SOURCES})
  set_target_properties(${name}_test PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  target_include_directories(${name}_test PRIVATE "${PROJECT_SOURCE_DIR}")
  target_compile_definitions(${name}_test PRIVATE
    ARMATURE_BINARY_DIR="${CMAKE_BINARY_DIR}" ARMATURE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name}_test PRIVATE ${arg_LIBS} GTest::gtest_main armature_warnings)
  add_test(NAME ${name} COMMAND ${name}_test)
  set_tests_properties(${name} PROPERTIES WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}" SKIP_RETURN_CODE 77)
endfunction()

# armature_install_test(COMPONENT)
#   Declares the tests COMPONENT_install, which runs install_test.cmake of the folder that calls it, and
#   COMPONENT_headers: every installed header compiles by itself.
function(armature_install_test component)
  set(sanitize)
  if(ARMATURE_SANITIZE)
    set(sanitize "-fsanitize=${ARMATURE_SANITIZE}")
  endif()
  add_test(NAME ${component}_install
    COMMAND "${CMAKE_COMMAND}" "-DBUILD=${PROJECT_BINARY_DIR}" "-DSOURCE=${PROJECT_SOURCE_DIR}"
      "-DGENERATOR=${CMAKE_GENERATOR}" "-DCOMPILER=${CMAKE_CXX_COMPILER}" "-DFLAGS=${sanitize}"
      -P "${CMAKE_CURRENT_SOURCE_DIR}/install_test.cmake")
  add_test(NAME ${component}_headers
    COMMAND "${CMAKE_COMMAND}" --build "${PROJECT_BINARY_DIR}" --target armature_${component}_verify_interface_header_sets)
  # Two builds must not write to one build tree at the same time.
  set_tests_properties(${component}_headers PROPERTIES RESOURCE_LOCK build_tree)
endfunction()

# armature_fuzzer(NAME SOURCES a.cpp... LIBS lib...)
#   Declares the libFuzzer program fuzzers/NAME, built by the target `fuzzers` of the preset `fuzz`; nothing elsewhere.
#   Its seeds, if any, are the files of tests/fuzz/corpus/NAME. `tools/check --full` runs each for a minute.
function(armature_fuzzer name)
  if(NOT ARMATURE_FUZZ)
    return()
  endif()
  cmake_parse_arguments(arg "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name}_fuzzer EXCLUDE_FROM_ALL ${arg_SOURCES})
  set_target_properties(${name}_fuzzer PROPERTIES
    OUTPUT_NAME ${name} RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/fuzzers")
  target_include_directories(${name}_fuzzer PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name}_fuzzer PRIVATE ${arg_LIBS} armature_warnings)
  target_link_options(${name}_fuzzer PRIVATE -fsanitize=fuzzer)
  add_dependencies(fuzzers ${name}_fuzzer)
endfunction()
