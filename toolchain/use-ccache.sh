# Sourced by scripts that build tests: lets CMake compile with ccache if its cache has any files, or if CI is set, to fill it.
# An empty cache would only cost time: hashing a precompiled header takes about as long as loading it.
if [ -n "${CI:-}" ] || [ "$(ccache --print-stats 2>/dev/null | sed -n 's/^files_in_cache[[:space:]]*//p')" != 0 ]; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_C_COMPILER_LAUNCHER=ccache
  # Without this setting, ccache does not cache compilations that use a precompiled header.
  export CCACHE_SLOPPINESS=pch_defines,time_macros
  # Several clones of the project share their results.
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
fi
