// Another program that runs beside this one, with a pipe on either side.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "nn/base/error.h"

namespace penumbra {

struct PipedProgram {
  pid_t process;
  int input, output;  // what is written to the one it reads; from the other comes what it prints
};

// `command` and its arguments; exit code 127 where there is no such program. Whoever writes to one that has
// ended gets SIGPIPE, unless that is ignored. Throws Error where there is no pipe or process to be had.
inline PipedProgram start_piped(std::vector<std::string> command) {
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) throw Error("no pipe to another program");
  const pid_t process = fork();
  if (process < 0) throw Error("cannot start " + command.front());
  if (process == 0) {
    dup2(to[0], STDIN_FILENO);
    dup2(from[1], STDOUT_FILENO);
    execvp(words[0], words.data());
    _exit(127);
  }
  close(to[0]);
  close(from[1]);
  return {process, to[1], from[0]};
}

}  // namespace penumbra
