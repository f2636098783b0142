// Expectations about error messages: a message that names neither file nor cause helps nobody, so tests check
// both.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

namespace penumbra::test {

// Runs `action`, which must throw an `ErrorType` whose message holds all `parts`.
template <typename ErrorType, typename Action>
void expect_error(const Action& action, std::initializer_list<std::string> parts) {
  try {
    action();
  } catch (const ErrorType& error) {
    const std::string message = error.what();
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos) << "no '" << part << "' in: " << message;
    }
    return;
  } catch (const std::exception& error) {
    ADD_FAILURE() << "an error of another type: " << error.what();
    return;
  }
  ADD_FAILURE() << "no error";
}

}  // namespace penumbra::test
