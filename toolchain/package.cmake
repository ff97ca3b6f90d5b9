# The files of the .debs besides the programs, and CPack's settings for them (tools/package): touchline for a board, and touchline-tools
# with the programs that touchline_program() calls tools.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME board)
install(FILES toolchain/package/touchline.service toolchain/package/touchline-setup.service DESTINATION lib/systemd/system)
install(FILES toolchain/package/touchline.rules DESTINATION lib/udev/rules.d RENAME 70-touchline.rules)
install(FILES toolchain/package/touchline.avahi DESTINATION share/touchline/avahi RENAME touchline.service)
# The console's page, if tools/console/build has built it.
install(DIRECTORY tools/console/dist/ DESTINATION share/touchline/console OPTIONAL)
install(CODE "execute_process(COMMAND \"${CMAKE_SOURCE_DIR}/toolchain/package/install-documentation\"
                                      \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share\" COMMAND_ERROR_IS_FATAL ANY)")

# Man pages made from --help, and files for the completion of words in bash and zsh. Not part of every build: for another processor an
# emulator runs the programs, which is slow.
set(manual ${CMAKE_BINARY_DIR}/manual)
get_property(programs GLOBAL PROPERTY TOUCHLINE_PROGRAMS)
foreach(program ${programs})
  set(run ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:${program}>)
  set(page ${manual}/${program}.1.gz)
  set(bash ${manual}/bash/${program})
  set(zsh ${manual}/zsh/_${program})
  add_custom_command(OUTPUT ${page} ${bash} ${zsh} DEPENDS ${program} toolchain/package/man-page
    COMMAND ${CMAKE_SOURCE_DIR}/toolchain/package/man-page ${program} ${PROJECT_VERSION} ${page} ${run}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${manual}/bash ${manual}/zsh
    COMMAND ${run} --completion bash >${bash}
    COMMAND ${run} --completion zsh >${zsh})
  list(APPEND pages ${page} ${bash} ${zsh})
  get_target_property(component ${program} TOUCHLINE_COMPONENT)
  install(FILES ${page} DESTINATION share/man/man1 COMPONENT ${component} OPTIONAL)
  install(FILES ${bash} DESTINATION share/bash-completion/completions COMPONENT ${component} OPTIONAL)
  install(FILES ${zsh} DESTINATION share/zsh/vendor-completions COMPONENT ${component} OPTIONAL)
endforeach()
add_custom_target(manual DEPENDS ${pages})

file(READ LICENSE license)
string(REGEX REPLACE "^.*(Copyright [^\n]*)\n\n" "" license "${license}")
string(REGEX REPLACE "\n$" "" license "${license}")
string(REPLACE "\n\n" "\n.\n" license "${license}")
string(REPLACE "\n" "\n " license " ${license}")
file(WRITE ${CMAKE_BINARY_DIR}/copyright
  "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: Touchline\n\n"
  "Files: *\nCopyright: 2026 The Touchline authors\nLicense: Expat\n${license}\n")
foreach(component board tools)
  set(package touchline)
  if(component STREQUAL tools)
    set(package touchline-tools)
  endif()
  # Written by tools/package.
  install(FILES ${CMAKE_BINARY_DIR}/changelog-${package}.gz DESTINATION share/doc/${package} COMPONENT ${component} RENAME changelog.gz OPTIONAL)
  install(FILES ${CMAKE_BINARY_DIR}/copyright DESTINATION share/doc/${package} COMPONENT ${component})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL board tools)
set(CPACK_DEBIAN_BOARD_PACKAGE_NAME touchline)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME touchline-tools)
set(about "Touchline watches a robot-soccer field from a camera above it, knows where\nevery robot and the ball are, decides how fast each robot has to move, and\ntells them by radio: every camera frame, on time.\n\n")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "vision and control for robot soccer")
set(CPACK_COMPONENT_BOARD_DESCRIPTION "${about}The package brings the firmware as a service with its page in a browser, the\nprograms that calibrate, and files for several boards.")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "${about}The package brings the programs that replay, cut and convert recordings,\ncompare results with the truth, measure latencies, and draw figures.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The Touchline authors <touchline@invalid.example.org>")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# libcamera-ipa: libcamera's modules for CSI cameras, which do not work without it.
set(CPACK_DEBIAN_BOARD_PACKAGE_DEPENDS "adduser, libcamera-ipa")
set(CPACK_DEBIAN_BOARD_PACKAGE_SUGGESTS "touchline-tools, v4l-utils, gpiod")
# stress-ng: for touchline-latency --load.
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS stress-ng)
# What depends on the version, which tools/package gives to cpack.
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_SOURCE_DIR}/toolchain/package/versions.cmake)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
foreach(script postinst prerm postrm)
  list(APPEND CPACK_DEBIAN_BOARD_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/toolchain/package/${script})
endforeach()
if(CMAKE_SYSROOT)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()
include(CPack)
