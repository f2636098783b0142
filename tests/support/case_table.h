// Tables of cases: what people's files look like, and what the program must do with them. A case is a record
// of lines "key: value"; records are separated by blank lines, '#' begins a comment line.
//
//   case: bom_in_times                     its name: a-z, 0-9 and _
//   why: Notepad writes a byte order mark  where such a file comes from
//   make: printf '\xef\xbb\xbf0.0\n' ...   prepares an empty folder of its own; any number of lines
//   run: penumbra slam . --out out         what is judged; any number of lines, the last one's exit code
//   counts exit: 0                                the code that is expected (default 0) says: 4 tracked a
//   text that output and messages together hold; any number not: lost                              a text
//   that they do not hold; any number needs: data                            skipped without the real data
//   (data), or the handed cases (cases)
//
// make and run are lines for `bash -eu`, in which `penumbra` is the built program and SOURCE, FIXTURES, DATA
// and CASES are the folders of the sources, of tests/fixtures, of the real data and of the cases beside it.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace penumbra::test {

struct Case {
  std::string kind;   // name of the table, without ending
  std::string place;  // "file:line", for messages
  std::string name, why, needs;
  std::vector<std::string> make, run, says, says_not;
  int exit_code = 0;
};

// For GoogleTest's messages.
inline void PrintTo(const Case& c, std::ostream* out) { *out << c.place << " (" << c.name << ")"; }

// All cases of the tables *.cases in `folder`, by kind. Throws InputError (file:line) for a key that is not
// known, a case without name, reason or something to run, and a name that stands twice.
std::vector<Case> read_case_tables(const std::filesystem::path& folder);

// What the commands of a case printed, standard output and error together, and the last exit code.
struct CaseResult {
  int exit_code = 0;
  std::string text;
};
// Runs the case in the folder `folder`.
CaseResult run_case(const Case& c, const std::filesystem::path& folder);

}  // namespace penumbra::test
