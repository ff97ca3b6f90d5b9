# The files of a .deb besides the programs, and CPack's settings for it (tools/package).
install(FILES toolchain/package/touchline.service toolchain/package/touchline-setup.service DESTINATION lib/systemd/system)
install(FILES toolchain/package/touchline.rules DESTINATION lib/udev/rules.d RENAME 70-touchline.rules)
install(FILES toolchain/package/touchline.avahi DESTINATION share/touchline/avahi RENAME touchline.service)
# The console's page, if tools/console/build has built it.
install(DIRECTORY tools/console/dist/ DESTINATION share/touchline/console OPTIONAL)
install(CODE "execute_process(COMMAND \"${CMAKE_SOURCE_DIR}/toolchain/package/install-documentation\"
                                      \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share\" COMMAND_ERROR_IS_FATAL ANY)")

# Man pages made from --help. Not part of every build: for another processor an emulator runs the programs, which is slow.
set(manual ${CMAKE_BINARY_DIR}/manual)
get_property(programs GLOBAL PROPERTY TOUCHLINE_PROGRAMS)
list(TRANSFORM programs REPLACE "(.+)" "${manual}/\\1.1.gz" OUTPUT_VARIABLE pages)
foreach(program ${programs})
  add_custom_command(OUTPUT ${manual}/${program}.1.gz DEPENDS ${program} toolchain/package/man-page
    COMMAND ${CMAKE_SOURCE_DIR}/toolchain/package/man-page ${program} ${PROJECT_VERSION} ${manual}/${program}.1.gz
            ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:${program}>)
endforeach()
add_custom_target(manual DEPENDS ${pages})
install(FILES ${pages} DESTINATION share/man/man1 OPTIONAL)
# Written by tools/package.
install(FILES ${CMAKE_BINARY_DIR}/changelog.gz DESTINATION share/doc/touchline OPTIONAL)

file(READ LICENSE license)
string(REGEX REPLACE "^.*(Copyright [^\n]*)\n\n" "" license "${license}")
string(REGEX REPLACE "\n$" "" license "${license}")
string(REPLACE "\n\n" "\n.\n" license "${license}")
string(REPLACE "\n" "\n " license " ${license}")
file(WRITE ${CMAKE_BINARY_DIR}/copyright
  "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: Touchline\n\n"
  "Files: *\nCopyright: 2026 The Touchline authors\nLicense: Expat\n${license}\n")
install(FILES ${CMAKE_BINARY_DIR}/copyright DESTINATION share/doc/touchline)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "watches a robot-soccer field and drives the robots")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
  "Touchline watches a robot-soccer field from a camera above it, knows where\nevery robot and the ball are, decides how fast each robot has to move, and\ntells them by radio: every camera frame, on time.\n\nThe package brings the firmware as a service, the programs that calibrate and\nmeasure, and files for several boards.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The Touchline authors <touchline@invalid.example.org>")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# libcamera-ipa: libcamera's modules for CSI cameras, which do not work without it.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "adduser, libcamera-ipa")
# stress-ng: for touchline-latency --load.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "stress-ng, v4l-utils, gpiod")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
foreach(script postinst prerm postrm)
  list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/toolchain/package/${script})
endforeach()
if(CMAKE_SYSROOT)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()
include(CPack)
