#include "tests/bench/peer.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "nn/base/error.h"

namespace penumbra {

Peer::Peer(std::vector<std::string> command) {
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) throw Error("no pipe to another program");
  process_ = fork();
  if (process_ == 0) {
    dup2(to[0], STDIN_FILENO);
    dup2(from[1], STDOUT_FILENO);
    execvp(words[0], words.data());
    _exit(127);
  }
  close(to[0]);
  close(from[1]);
  questions_ = fdopen(to[1], "w");
  answers_ = fdopen(from[0], "r");
  if (process_ < 0) throw Error("cannot start " + command.front());
  const std::string line = read_line();
  facts_ = nlohmann::ordered_json::parse(line, nullptr, false);
  if (!facts_.is_object()) facts_ = {{"missing", command.front() + " did not answer"}};
}

Peer::~Peer() {
  if (questions_ != nullptr) std::fclose(questions_);
  if (answers_ != nullptr) std::fclose(answers_);
  if (process_ > 0) waitpid(process_, nullptr, 0);
}

bool Peer::runs(const std::string& what) const {
  const auto runs = facts_.find("runs");
  return runs != facts_.end() && std::find(runs->begin(), runs->end(), what) != runs->end();
}

double Peer::seconds(const std::string& what) {
  std::fprintf(questions_, "%s\n", what.c_str());
  std::fflush(questions_);
  const std::string answer = read_line();
  if (answer.empty()) throw Error("another engine ended: " + facts_.dump());
  return std::strtod(answer.c_str(), nullptr);
}

std::string Peer::read_line() {
  std::string line;
  for (int c = std::getc(answers_); c != EOF && c != '\n'; c = std::getc(answers_))
    line += static_cast<char>(c);
  return line;
}

}  // namespace penumbra
