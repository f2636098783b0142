// Errors: what is thrown where data enters (files, arguments, shapes). Hot paths take checked data and do not
// throw. Every message says where, what was expected and what was found.
#pragma once

#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <string_view>

namespace penumbra {

// Base of every error that Penumbra throws; the program ends with exit code 1 and prints what().
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Data from outside is not what it should be: "place: expected X, found Y".
// `place` names the file and, where it helps, the line, byte or tensor in it.
class InputError : public Error {
 public:
  InputError(std::string_view place, std::string_view expected, std::string_view found)
      : Error(fmt::format("{}: expected {}, found {}", place, expected, found)) {}
};

// The command line asks for something that does not exist or does not fit together; exit code 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

}  // namespace penumbra
