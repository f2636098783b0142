#include "tests/bench/peer.h"

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

#include "nn/base/error.h"
#include "tests/bench/piped_program.h"

namespace penumbra {

Peer::Peer(const std::vector<std::string>& command) {
  const PipedProgram program = start_piped(command);
  process_ = program.process;
  questions_ = fdopen(program.input, "w");
  answers_ = fdopen(program.output, "r");
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
