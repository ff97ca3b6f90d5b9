# Writes the files of FOLDER as C++ into OUT: cmake -DFOLDER=... -DOUT=... -P embed_radio_presets.cmake
file(GLOB files "${FOLDER}/*.toml")
list(SORT files)
set(entries "")
foreach(file IN LISTS files)
  get_filename_component(name "${file}" NAME_WE)
  file(READ "${file}" content)
  string(APPEND entries "    {\"${name}\", R\"toml(${content})toml\"},\n")
endforeach()
list(LENGTH files count)
file(WRITE "${OUT}" "#include \"firmware/config/radio_presets.h\"

#include <array>

namespace touchline::config {
namespace {
constexpr std::array<RadioPreset, ${count}> kRadioPresets{{
${entries}}};
}  // namespace

std::span<const RadioPreset> radio_presets() { return kRadioPresets; }

}  // namespace touchline::config
")
