// What the program says beside its results, on stderr: "warning: ...", coloured on a terminal.
#pragma once

#include <fmt/core.h>

#include <string_view>
#include <utility>

namespace penumbra::apps {

enum class LogLevel { info, warning, error };

// From any thread.
void log_line(LogLevel level, std::string_view text);

template <class... Arguments>
void log_info(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  log_line(LogLevel::info, fmt::format(format, std::forward<Arguments>(arguments)...));
}
template <class... Arguments>
void log_warning(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  log_line(LogLevel::warning, fmt::format(format, std::forward<Arguments>(arguments)...));
}
template <class... Arguments>
void log_error(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  log_line(LogLevel::error, fmt::format(format, std::forward<Arguments>(arguments)...));
}

}  // namespace penumbra::apps
