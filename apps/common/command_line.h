// How the program was called, so that a run can be repeated.
#pragma once

#include <string>
#include <string_view>

namespace penumbra::apps {

extern const char* const kVersion;  // of the program, such as "0.1.0"

// A word as a shell takes it: in quotes where it is empty or has blanks or special characters.
std::string in_shell_quotes(std::string_view word);

// From main(), before anything else.
void remember_command_line(int argc, const char* const* argv);

// The call as a shell takes it: words with blanks or special characters are quoted. Empty where main() did
// not remember one.
const std::string& command_line();

}  // namespace penumbra::apps
