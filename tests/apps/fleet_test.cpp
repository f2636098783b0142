// The plan of a fleet and what is said of it; tests/fleet/test.sh does one on a real Slurm.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <thread>

#include "apps/common/interruption.h"
#include "apps/fleet/fleet_report.h"
#include "apps/fleet/plan.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::apps {
namespace {

namespace fs = std::filesystem;

class Fleet : public ::testing::Test {
 protected:
  void write(const fs::path& path, const std::string& text) const {
    fs::create_directories((folder / path).parent_path());
    nn::write_file(folder / path, text);
  }
  std::vector<FleetRecording> read(const std::string& manifest) const {
    write("manifest.txt", manifest);
    return read_fleet_manifest(folder / "manifest.txt");
  }

  const test::TemporaryDirectory temporary;
  const fs::path folder = temporary.path();
};

TEST_F(Fleet, AManifestIsWordsAsAShellHasThem) {
  write("new bags/1.mcap", "");
  write("rig.yaml", "");
  const fs::path before = fs::current_path();
  const std::vector<FleetRecording> found = read(
      "# the night\n\n"
      "monday  'new bags/1.mcap' -   # no calibration\n"
      "tues.2 new\\ bags/1.mcap rig.yaml --frames 0:30 --settings \"rig.yaml\"\n");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "monday");
  EXPECT_EQ(found[0].arguments, (std::vector<std::string>{"new bags/1.mcap"}));
  EXPECT_EQ(found[1].arguments, (std::vector<std::string>{"new bags/1.mcap", "--camera", "rig.yaml",
                                                          "--frames", "0:30", "--settings", "rig.yaml"}));
  EXPECT_EQ(fs::current_path(), before);
}

TEST_F(Fleet, AManifestIsRefusedBeforeAThousandJobsFail) {
  write("a.bag", "");
  const struct {
    std::string text;
    std::vector<std::string> parts;
  } cases[] = {
      {"# nothing\n", {"manifest.txt", "a recording a line"}},
      {"\na a.bag\n", {"manifest.txt:2", "a calibration (or -)"}},
      {"a 'a.bag -\n", {"manifest.txt:1", "a second '"}},
      {"a/b a.bag -\n", {"letters, digits", "a/b"}},
      {".. a.bag -\n", {"letters, digits"}},
      {"a b.bag -\n", {"a recording", "b.bag, which is not there"}},
      {"a a.bag rig.yaml\n", {"a calibration", "rig.yaml"}},
      {"a a.bag -\nb a.bag -\na a.bag -\n", {"manifest.txt:3", "a name of its own", "line 1"}},
      {"a a.bag - --frams 3\n", {"manifest.txt:1", "options of penumbra slam", "--frams"}},
      {"a a.bag - --filter sometimes\n", {"--filter"}},
      {"a a.bag - --settings none.json\n", {"none.json"}},
      {"a a.bag - --out elsewhere\n", {"that the plan gives", "--out"}},
      {"a a.bag - --save-map=x.map\n", {"--save-map"}},
  };
  for (const auto& [text, parts] : cases) {
    for (const std::string& part : parts)
      test::expect_error<InputError>([&, &text = text] { read(text); }, {part});
  }
}

TEST_F(Fleet, APlanIsScriptsAndALineARecording) {
  FleetPlan plan;
  plan.recordings = {{"one", {"it's here.bag", "--filter", "off"}}, {"two", {"b.bag"}}};
  plan.folder = "/data/night 1";
  plan.program = "/opt/penumbra";
  plan.sbatch = {"--account=lab", "--comment=two words"};
  write_fleet_plan(folder / "plan", plan);
  EXPECT_EQ(nn::read_file(folder / "plan/jobs.tsv", "text"),
            "one\t/data/night 1\t'it'\\''s here.bag' --filter off\ntwo\t/data/night 1\tb.bag\n");
  const std::string settings = nn::read_file(folder / "plan/settings.sh", "text");
  EXPECT_NE(settings.find("all_options=(--account=lab '--comment=two words')"), std::string::npos)
      << settings;
  for (const char* script : {"step.sh", "submit.sh", "here.sh"}) {
    const fs::perms permissions = fs::status(folder / "plan" / script).permissions();
    EXPECT_NE(permissions & fs::perms::owner_exec, fs::perms::none) << script;
  }
}

TEST_F(Fleet, EachRecordingIsDoneOrSaysWhyNot) {
  write("jobs.tsv", "a\t/x\ta.bag\nb\t/x\tb.bag\nc\t/x\tc.bag\nd\t/x\td.bag\ne\t/x\te.bag\n");
  write("runs/a/done", "/x\ta.bag\n");
  write("runs/a/run.json", R"({"frames": 30, "tracked": 29, "keyframes": 4, "path_m": 12.34,
                               "ground_truth": {"ape_rmse_m": 0.0123}})");
  write("runs/b/log.txt", "== Monday\nerror: yesterday's\n== Tuesday\nerror: b.bag: <torn>\nresults in b\n");
  write("runs/c/log.txt", "== Monday\nerror: interrupted by SIGTERM after 7 frames\n");
  write("runs/c/run.json", R"({"frames": 7, "error": "interrupted by SIGTERM after 7 frames"})");
  write("runs/d/done", "/x\td.bag --frames 0:3\n");  // of an earlier plan
  write("runs/d/log.txt", "== Monday\nended with exit code 137\n");
  write("runs/d/run.json", "{\"frames\": ");
  EXPECT_EQ(fleet_table(read_fleet(folder)),
            "recording\tstate\tframes\tlocated\tkeyframes\tpath m\tAPE m\tlast words\n"
            "a\tdone\t30\t29\t4\t12.3\t0.0123\t\n"
            "b\tfailed\t-\t-\t-\t-\t-\tb.bag: <torn>\n"
            "c\tstopped\t7\t-\t-\t-\t-\tinterrupted by SIGTERM after 7 frames\n"
            "d\tnot begun\t-\t-\t-\t-\t-\t\n"
            "e\tnot begun\t-\t-\t-\t-\t-\t\n");
  const std::string page = fleet_page(folder, read_fleet(folder));
  EXPECT_NE(page.find("1 of 5 recordings are done"), std::string::npos);
  EXPECT_NE(page.find("&lt;torn&gt;"), std::string::npos);
  EXPECT_EQ(why_not_merged(folder), "not begun");
  write("merged/log.txt", "== Monday\nerror: b.map: another camera\nended with exit code 1\n");
  EXPECT_EQ(why_not_merged(folder), "b.map: another camera");
  write("merged/done", "a");
  EXPECT_EQ(why_not_merged(folder), "");
  test::expect_error<InputError>([&] { read_fleet(folder / "runs"); }, {"jobs.tsv"});
}

TEST(Interruption, ASignalThatComesTwiceAtOnceIsOne) {
  const Interruption interruption;
  raise(SIGTERM);
  raise(SIGTERM);  // the second would end this process
  EXPECT_TRUE(Interruption::requested());
  EXPECT_EQ(Interruption::signal_name(), "SIGTERM");
}

TEST(InterruptionDeathTest, ASecondSignalAWhileLaterEndsAtOnce) {
  EXPECT_EXIT(
      {
        const Interruption interruption;
        raise(SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
        raise(SIGTERM);
        exit(0);
      },
      testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace penumbra::apps
