# armature_install_package(COMPONENT)
#   Installs with COMPONENT what makes find_package(armature COMPONENTS COMPONENT) work. The folder that calls it
#   installs armature-COMPONENT.cmake, which finds what the component needs and includes its targets.
include(CMakePackageConfigHelpers)

function(armature_install_package component)
  set(destination "${CMAKE_INSTALL_LIBDIR}/cmake/armature")
  configure_package_config_file("${PROJECT_SOURCE_DIR}/tools/cmake/armature-config.cmake.in"
    "${PROJECT_BINARY_DIR}/armature-config.cmake" INSTALL_DESTINATION "${destination}")
  write_basic_package_version_file("${PROJECT_BINARY_DIR}/armature-config-version.cmake"
    COMPATIBILITY SameMinorVersion)
  install(FILES "${PROJECT_BINARY_DIR}/armature-config.cmake" "${PROJECT_BINARY_DIR}/armature-config-version.cmake"
    DESTINATION "${destination}" COMPONENT ${component})
endfunction()
