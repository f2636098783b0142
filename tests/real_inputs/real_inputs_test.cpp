// Files as people have them, and what the program must do with each: a row of *.cases is a test.
#include <gtest/gtest.h>

#include "tests/support/case_table.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

class RealInput : public testing::TestWithParam<Case> {};

TEST_P(RealInput, IsReadOrRefusedAsTheTableSays) {
  const Case& c = GetParam();
  if (c.needs == "data") {
    PENUMBRA_REAL_DATA(data, "");
  } else if (c.needs == "cases" && !std::filesystem::exists(cases_root())) {
    GTEST_SKIP() << "no " << cases_root();
  }
  const TemporaryDirectory folder;
  const CaseResult result = run_case(c, folder.path());
  const std::string shown = c.place + " (" + c.why + ")\n" + result.text;
  EXPECT_EQ(result.exit_code, c.exit_code) << shown;
  for (const std::string& text : c.says)
    EXPECT_NE(result.text.find(text), std::string::npos) << "does not say: " << text << '\n' << shown;
  for (const std::string& text : c.says_not)
    EXPECT_EQ(result.text.find(text), std::string::npos) << "says: " << text << '\n' << shown;
}

INSTANTIATE_TEST_SUITE_P(Table, RealInput,
                         testing::ValuesIn(read_case_tables(source_path("tests/real_inputs"))),
                         [](const auto& info) { return info.param.kind + "_" + info.param.name; });

}  // namespace
}  // namespace penumbra::test
