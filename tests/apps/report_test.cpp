#include <fmt/core.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/browser.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra {
namespace {

// The JSON in the page's `data` element.
nlohmann::json data_of(const std::string& page) {
  const std::string begin = "<script id=\"data\" type=\"application/json\">";
  const std::size_t at = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
}

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// One drive for all tests: the page only reads it.
class Report : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared = std::make_unique<test::TemporaryDirectory>();
    const std::string folder = shared->path().string();
    ASSERT_EQ(test::run_penumbra(fmt::format("synth --frames 12 --size 310x94 --out '{}/street'", folder))
                  .exit_code,
              0);
    const auto slam = test::run_penumbra(fmt::format("slam '{0}/street' --out '{0}/run'", folder));
    ASSERT_EQ(slam.exit_code, 0) << slam.err;
  }
  static void TearDownTestSuite() { shared.reset(); }

  // A copy that a test may damage.
  Report() { std::filesystem::copy(*shared / "run", run, std::filesystem::copy_options::recursive); }
  test::ProgramResult report() { return test::run_penumbra(fmt::format("report '{}'", run.string())); }
  std::string page() const { return test::read_file(run / "report.html"); }

  static std::unique_ptr<test::TemporaryDirectory> shared;
  test::TemporaryDirectory own;
  std::filesystem::path run = own / "run";
};
std::unique_ptr<test::TemporaryDirectory> Report::shared;

TEST_F(Report, HoldsTheNumbersOfTheRun) {
  const test::ProgramResult result = report();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json data = data_of(page());
  EXPECT_EQ(data["run"], nlohmann::json::parse(test::read_file(run / "run.json")));
  EXPECT_EQ(data["frames"], nlohmann::json::parse(test::read_file(run / "frames.json")));
  EXPECT_EQ(data["estimate"].size(), 12U);
  EXPECT_EQ(data["truth"].size(), 12U);
  EXPECT_EQ(data["error"].size(), 12U);
  EXPECT_EQ(data["gallery"].size(), data["run"]["keyframes"]);
  const std::string folder = shared->path().string();
  EXPECT_EQ(data["run"]["command"], fmt::format("penumbra slam {0}/street --out {0}/run", folder));
  EXPECT_EQ(data["run"]["version"], "0.1.0");
}

TEST_F(Report, NeedsNoNetwork) {
  ASSERT_EQ(report().exit_code, 0);
  const std::string html = page();
  for (const char* loads : {"<link", "src=\"http", "src='http", "@import", "url("}) {
    EXPECT_EQ(html.find(loads), std::string::npos) << loads;
  }
}

TEST_F(Report, LoadsInABrowserAndDrawsEverything) {
  const std::string browser = test::find_browser();
  if (browser.empty()) GTEST_SKIP() << test::kNoBrowser;
  nlohmann::json json = nlohmann::json::parse(test::read_file(run / "run.json"));
  json["loops"] = {{0, 11}};
  json["warnings"] = {"the baseline is 537 m"};
  write(run / "run.json", json.dump());
  ASSERT_EQ(report().exit_code, 0);
  const std::string dom = test::dump_dom(browser, "file://" + (run / "report.html").string());
  ASSERT_FALSE(dom.empty()) << browser << " did not show the page";
  EXPECT_NE(dom.find("data-ready=\"yes\""), std::string::npos) << "the page had problems";
  for (const char* part : {"id=\"summary\" data-drawn=", "id=\"gallery\" data-drawn="}) {
    EXPECT_NE(dom.find(part), std::string::npos) << part;
  }
  for (const char* id : {"top", "space", "error", "time", "filter"})
    EXPECT_TRUE(test::is_drawn(dom, id)) << id;
  EXPECT_NE(dom.find("<li>the baseline is 537 m</li>"), std::string::npos);
  EXPECT_NE(dom.find(json["command"].get<std::string>()), std::string::npos) << "how to repeat the run";
  EXPECT_NE(dom.find(fmt::format("{} map points", json["map_points"].get<int>())), std::string::npos);
}

TEST_F(Report, ShowsARunWithoutGroundTruthAndGallery) {
  std::filesystem::remove(run / "ground_truth_tum.txt");
  std::filesystem::remove_all(run / "gallery");
  std::filesystem::remove(run / "map.ply");
  ASSERT_EQ(report().exit_code, 0);
  const nlohmann::json data = data_of(page());
  EXPECT_TRUE(data["truth"].empty());
  EXPECT_TRUE(data["gallery"].empty());
}

TEST_F(Report, LetsNoNameEndTheScript) {
  nlohmann::json json = nlohmann::json::parse(test::read_file(run / "run.json"));
  json["dataset"] = "</script><script>alert(1)</script>";
  write(run / "run.json", json.dump());
  ASSERT_EQ(report().exit_code, 0);
  EXPECT_EQ(page().find("<script>alert"), std::string::npos);
  EXPECT_EQ(data_of(page())["run"]["dataset"], json["dataset"]);
}

TEST_F(Report, NamesTheFileThatIsMissingOrTorn) {
  const auto expect_complaint = [&](const char* file) {
    const test::ProgramResult result = report();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find(file), std::string::npos) << result.err;
  };
  const std::string ply = test::read_file(run / "map.ply"), frames = test::read_file(run / "frames.json");
  write(run / "map.ply", ply.substr(0, ply.size() - 7));
  expect_complaint("map.ply");
  write(run / "map.ply", ply);
  write(run / "frames.json", frames.substr(0, frames.size() / 2));
  expect_complaint("frames.json");
  write(run / "frames.json", "{\"index\": [1], \"ms\": [1], \"filter\": [null]}");
  expect_complaint("frames.json");
  std::filesystem::remove(run / "run.json");
  expect_complaint("run.json");
  EXPECT_FALSE(std::filesystem::exists(run / "report.html"));
}

}  // namespace
}  // namespace penumbra
