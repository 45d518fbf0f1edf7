# What `cpack` makes: a Debian package of the appliance and the command.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME armature)
set(CPACK_PACKAGE_VENDOR "Armature")
set(CPACK_PACKAGE_CONTACT "Armature <armature@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION "armatured sees a person through a depth camera and publishes camera
velocities that seven small motions of the body steer. With it come the
command armature, the viewer, and libraries to subscribe and to abstract,
deform and select shapes.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION misc)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Without these it runs by hand, reads fewer mesh formats, and draws in software or not at all.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "systemd, udev, libassimp5, fonts-inter, libegl1, libgl1-mesa-dri")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
  "${PROJECT_SOURCE_DIR}/tools/packaging/postinst"
  "${PROJECT_SOURCE_DIR}/tools/packaging/prerm"
  "${PROJECT_SOURCE_DIR}/tools/packaging/postrm")
include(CPack)

set(daemon "${PROJECT_SOURCE_DIR}/tracker/daemon")
install(FILES "${daemon}/armatured.service" DESTINATION lib/systemd/system)
install(FILES "${daemon}/60-armature.rules" DESTINATION lib/udev/rules.d)
install(FILES "${daemon}/armature.sysusers" DESTINATION lib/sysusers.d RENAME armature.conf)
install(FILES "${daemon}/armature.tmpfiles" DESTINATION lib/tmpfiles.d RENAME armature.conf)
install(FILES "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md" "${PROJECT_SOURCE_DIR}/LICENSE"
  "${PROJECT_SOURCE_DIR}/tools/packaging/copyright"
  DESTINATION share/doc/armature)
execute_process(COMMAND gzip -9nc "${PROJECT_SOURCE_DIR}/CHANGELOG.md"
  OUTPUT_FILE "${PROJECT_BINARY_DIR}/changelog.gz" COMMAND_ERROR_IS_FATAL ANY)
install(FILES "${PROJECT_BINARY_DIR}/changelog.gz" DESTINATION share/doc/armature)
# To start from: postinst copies it to /etc/armature/daemon where there is none. No conffile: the daemon writes its own,
# and an upgrade would stop at dpkg's question whose version to keep.
install(FILES "${daemon}/armatured.toml" DESTINATION share/armature)
