# The programs of both packages share their file formats, so both have one version. An older touchline may be undivided and contain the files
# of touchline-tools.
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "touchline (= ${CPACK_DEBIAN_PACKAGE_VERSION})")
set(CPACK_DEBIAN_TOOLS_PACKAGE_BREAKS "touchline (<< ${CPACK_DEBIAN_PACKAGE_VERSION})")
set(CPACK_DEBIAN_TOOLS_PACKAGE_REPLACES "touchline (<< ${CPACK_DEBIAN_PACKAGE_VERSION})")
