#pragma once

#include <span>
#include <string>

#include "hal/result.h"

// The reference of all keys, generated from their declarations.
namespace touchline::config {

/// Returns text for the terminal: two or three lines for each key of the three files and each standard layout whose
/// file, path or meaning contains all of `words`, in upper or lower case. kNotFound: no key or layout contains the
/// words; the text says which word is unknown.
Result<std::string> key_reference_text(std::span<const std::string> words);

/// Returns the text for docs/files.md: a table for each section of the three files.
std::string key_reference_markdown();

/// Returns the page with key_reference_markdown() between the lines kReferenceBegin and kReferenceEnd. kNotFound: the
/// page does not have both lines.
Result<std::string> updated_key_reference(std::string page);

inline constexpr const char* kReferenceBegin =
    "<!-- Begin of the reference. Do not edit it: `touchline keys --update docs/files.md` writes it. -->\n";
inline constexpr const char* kReferenceEnd = "<!-- End of the reference. -->\n";

}  // namespace touchline::config
