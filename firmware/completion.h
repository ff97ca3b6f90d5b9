#pragma once

#include <CLI/App.hpp>
#include <string>

// Scripts that complete the words of a program's command line, made from its declaration (parse_arguments.h).
namespace touchline {

/// For bash, without the package bash-completion: `source <(PROGRAM --completion bash)`, or a file PROGRAM in
/// /usr/share/bash-completion/completions.
std::string bash_completion(const CLI::App& program);

/// For zsh: `source <(PROGRAM --completion zsh)` after compinit, or a file _PROGRAM in a folder of fpath.
std::string zsh_completion(const CLI::App& program);

}  // namespace touchline
