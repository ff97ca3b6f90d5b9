#pragma once

#include <CLI/App.hpp>
#include <string>

// Makes scripts that complete the words of a command line from the program's declaration (parse_arguments.h).
namespace touchline {

/// Returns the script for bash. It does not need the package bash-completion: `source <(PROGRAM --completion bash)`, or
/// a file PROGRAM in /usr/share/bash-completion/completions.
std::string bash_completion(const CLI::App& program);

/// Returns the script for zsh: `source <(PROGRAM --completion zsh)` after compinit, or a file _PROGRAM in a folder of
/// fpath.
std::string zsh_completion(const CLI::App& program);

}  // namespace touchline
