// `penumbra slam --view`: what its server answers, and what a browser makes of it.
#include <arpa/inet.h>
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "apps/slam/slam_results.h"
#include "apps/view/live_view.h"
#include "nn/base/error.h"
#include "slam/sources/open_dataset.h"
#include "tests/support/browser.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra {
namespace {

using nlohmann::json;

int port_of(const std::string& address) {  // "http://127.0.0.1:PORT/"
  return std::stoi(address.substr(address.rfind(':') + 1));
}

class Connection {
 public:
  explicit Connection(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }
  ~Connection() { close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool is_connected() const { return connected_; }
  void say(const std::string& text) {
    static_cast<void>(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL));
  }
  // All that comes until the other side closes.
  std::string hear() {
    std::string text;
    char buffer[4096];
    for (ssize_t n; (n = recv(socket_, buffer, sizeof buffer, 0)) > 0;)
      text.append(buffer, static_cast<std::size_t>(n));
    return text;
  }

 private:
  int socket_;
  bool connected_ = false;
};

struct Reply {
  int status = 0;  // 0: none
  std::string headers, body;
};

Reply ask(int port, const std::string& request) {
  Connection connection(port);
  connection.say(request);
  const std::string text = connection.hear();
  const std::size_t end = text.find("\r\n\r\n");
  if (end == text.npos || text.rfind("HTTP/1.1 ", 0) != 0) return {};
  return {std::stoi(text.substr(9, 3)), text.substr(0, end), text.substr(end + 4)};
}

Reply get(int port, const std::string& path, const std::string& host = "127.0.0.1") {
  return ask(port, fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n\r\n", path, host));
}

json state_of(int port, long since = 0) {
  return json::parse(get(port, fmt::format("/state.json?since={}", since)).body);
}

// A drive of a dozen frames, in this process: it goes on when a test says so.
class View : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared = std::make_unique<test::TemporaryDirectory>();
    ASSERT_EQ(test::run_penumbra(fmt::format("synth --frames 12 --size 310x94 --out '{}'", street().string()))
                  .exit_code,
              0);
  }
  static void TearDownTestSuite() { shared.reset(); }
  static std::filesystem::path street() { return *shared / "street"; }

  View() { run.dataset = "A <small> street"; }

  void drive(int frames) {
    for (int i = 0; i < frames; ++i) {
      const slam::StereoImages images = dataset->load(static_cast<int>(record.frames().size()));
      view.add(record.add(slam.process(images)), images.left);
    }
  }
  void finish() {
    record.finish();
    run.finished = true;
    apps::write_results({out.path(), {}}, *dataset, record, nullptr, run);
    state_of(port);  // so that somebody looks
    view.finish(out.path());
  }

  static std::unique_ptr<test::TemporaryDirectory> shared;
  test::TemporaryDirectory out;
  std::unique_ptr<slam::StereoDataset> dataset = slam::open_dataset(street(), {});
  apps::SlamRun run;
  slam::Slam slam{dataset->camera(), dataset->sensor(), {}};
  slam::Recorder record{slam};
  apps::LiveView view{0, run, dataset->size(), record};
  const int port = port_of(view.address());
};
std::unique_ptr<test::TemporaryDirectory> View::shared;

TEST_F(View, TellsWhatIsNewSinceTheLastAnswer) {
  EXPECT_EQ(state_of(port)["rows"]["index"].size(), 0U);
  EXPECT_EQ(get(port, "/image.jpg").status, 404);
  drive(7);
  const json first = state_of(port);
  EXPECT_EQ(first["from"], 0);
  EXPECT_EQ(first["total"], 12);
  EXPECT_EQ(first["finished"], false);
  EXPECT_EQ(first["rows"]["state"], json(std::vector<std::string>(7, "tracking")));
  int keyframes = 0;
  for (int i = 0; i < 7; ++i) {
    const auto row = static_cast<std::size_t>(i);
    keyframes += record.frames()[row].keyframe;
    EXPECT_EQ(first["rows"]["index"][row], i);
    EXPECT_GT(first["rows"]["ms"][row], 0.0);
    const Eigen::Vector3d position = record.trajectory()[row].T_wc.translation;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(first["rows"]["position"][row][static_cast<std::size_t>(k)], position[k], 0.02);
  }
  EXPECT_EQ(first["keyframes"], keyframes);
  const json none = state_of(port, first["version"]);
  EXPECT_EQ(none["from"], 7);
  EXPECT_EQ(none["rows"]["index"].size(), 0U);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // between two pictures
  drive(1);
  const json next = state_of(port, first["version"]);
  EXPECT_LE(next["from"], 7);
  EXPECT_EQ(next["rows"]["index"].back(), 7);

  const Reply picture = get(port, "/image.jpg");
  EXPECT_EQ(picture.status, 200);
  EXPECT_EQ(picture.body.substr(0, 2), "\xFF\xD8");
  EXPECT_FALSE(json::parse(get(port, "/points.json").body)["position"].get<std::string>().empty());
  EXPECT_EQ(get(port, "/report.json").status, 404);  // not yet
}

TEST_F(View, AnswersNothingElse) {
  drive(1);
  EXPECT_EQ(get(port, "/").status, 200);
  EXPECT_EQ(get(port, "/", "localhost:1234").status, 200);  // through a tunnel
  for (const char* path : {"/index.html", "/state", "/state.json/", "/../state.json", "//state.json",
                           "/etc/passwd", "/../../../../../../etc/passwd", "http://127.0.0.1/", "*"}) {
    EXPECT_EQ(get(port, path).status, 404) << path;
  }
  for (const char* method : {"POST", "PUT", "DELETE", "HEAD", "OPTIONS", "PATCH"}) {
    EXPECT_EQ(
        ask(port, fmt::format("{} / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\n\r\nabc", method))
            .status,
        404)
        << method;
  }
  // Names that were made to lead here.
  for (const char* host : {"evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80", ""}) {
    EXPECT_NE(get(port, "/state.json", host).status, 200) << host;
  }
  EXPECT_EQ(get(port, "/state.json", "evil.example").status, 403);
  EXPECT_EQ(ask(port, "GET / HTTP/1.1\r\n\r\n").status, 403);
  EXPECT_EQ(ask(port, "GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n").status, 403);
}

TEST_F(View, OutlastsRequestsThatAreTooLargeOrNeverEnd) {
  const std::string line(4000, 'x');
  std::string large = "GET / HTTP/1.1\r\nHost: localhost\r\n";
  for (int i = 0; i < 100; ++i) large += fmt::format("X-{}: {}\r\n", i, line);
  EXPECT_NE(ask(port, large + "\r\n").status, 200);
  EXPECT_NE(ask(port, "GET /" + std::string(60000, 'a') + " HTTP/1.1\r\nHost: localhost\r\n\r\n").status,
            200);
  EXPECT_NE(ask(port, std::string("\0\xFF\x16\x03\r\n\r\n", 8)).status, 200);
  EXPECT_EQ(get(port, "/state.json?since=99999999999999999999999").status, 200);
  EXPECT_EQ(get(port, "/state.json?since=%00&since=-1").status, 200);

  std::vector<std::unique_ptr<Connection>> silent;
  for (int i = 0; i < 12; ++i) {
    silent.push_back(std::make_unique<Connection>(port));
    silent.back()->say("GET / HTT");
  }
  drive(2);  // waits for nobody
  silent.resize(3);
  EXPECT_EQ(get(port, "/state.json").status, 200);
}

TEST_F(View, EndsWithTheReportOfTheRun) {
  const std::string browser = test::find_browser();
  drive(7);
  state_of(port);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // between two pictures
  drive(1);
  const std::string during = browser.empty() ? "" : test::dump_dom(browser, view.address(), 3000);
  drive(4);
  finish();
  const json state = state_of(port);
  EXPECT_EQ(state["finished"], true);
  EXPECT_EQ(state["rows"]["index"].size(), 12U);
  const json report = json::parse(get(port, "/report.json").body),
             run_file = test::read_json(out / "run.json");
  EXPECT_EQ(report["run"], run_file);
  EXPECT_EQ(report["run"]["frames"], 12);
  EXPECT_EQ(report["estimate"].size(), 12U);

  if (browser.empty()) GTEST_SKIP() << test::kNoBrowser;
  EXPECT_NE(during.find("data-state=\"running\""), std::string::npos) << during.substr(0, 300);
  EXPECT_NE(during.find("id=\"problem\" hidden"), std::string::npos) << "the page had problems";
  EXPECT_NE(during.find("running: 8 of 12 frames"), std::string::npos);
  EXPECT_NE(during.find("<b>7</b><span>frame</span>"), std::string::npos);
  EXPECT_NE(during.find("id=\"picture\""), std::string::npos);
  for (const char* id : {"now", "top", "space", "time"}) EXPECT_TRUE(test::is_drawn(during, id)) << id;

  const std::string after = test::dump_dom(browser, view.address());
  EXPECT_NE(after.find("data-state=\"finished\""), std::string::npos);
  EXPECT_NE(after.find("data-ready=\"yes\""), std::string::npos) << "the page had problems";
  EXPECT_NE(after.find(">finished: 12 frames"), std::string::npos);
  for (const char* id : {"summary", "top", "space", "error", "time", "filter", "gallery"})
    EXPECT_TRUE(test::is_drawn(after, id)) << id;
  for (const char* key : {"frames", "lost", "keyframes", "map_points"}) {
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    const std::string tile = fmt::format("<b>{}</b><span>{}</span>", run_file[key].get<int>(), name);
    EXPECT_NE(after.find(tile), std::string::npos) << tile;
  }
}

TEST_F(View, NamesThePortThatIsTaken) {
  const std::string message =
      test::message_of<Error>([&] { const apps::LiveView second(port, run, 1, record); });
  EXPECT_CONTAINS(message, std::to_string(port));
  const std::string start = fmt::format("slam '{}' --out '{}' ", street().string(), (out / "run").string());
  const test::ProgramResult taken = test::run_penumbra(fmt::format("{} --view={}", start, port));
  EXPECT_EQ(taken.exit_code, 1);
  EXPECT_CONTAINS(taken.err, std::to_string(port));
  EXPECT_FALSE(std::filesystem::exists(out / "run/run.json"));
  for (const char* wrong : {"65536", "-1", "x", "80x"}) {
    EXPECT_EQ(test::run_penumbra(fmt::format("{} --view={}", start, wrong)).exit_code, 2) << wrong;
  }
}

// The same drive to and fro: long enough for somebody to come and look.
std::filesystem::path drive_to_and_fro(const std::filesystem::path& street, const std::filesystem::path& at) {
  constexpr int kFrames = 100, kOneWay = 12, kRound = 2 * kOneWay - 2;
  const std::filesystem::path from = street / "sequences/00";
  std::string times;
  for (const char* side : {"image_0", "image_1"}) std::filesystem::create_directories(at / side);
  for (int i = 0; i < kFrames; ++i) {
    times += fmt::format("{:.1f}\n", 0.1 * i);
    const int on_way = i % kRound, frame = std::min(on_way, kRound - on_way);
    for (const char* side : {"image_0", "image_1"}) {
      std::filesystem::create_hard_link(from / side / fmt::format("{:06}.png", frame),
                                        at / side / fmt::format("{:06}.png", i));
    }
  }
  test::write_file(at / "times.txt", times);
  std::filesystem::copy(from / "calib.txt", at / "calib.txt");
  return at;
}

// The program itself, watched from its first frame on and not watched.
TEST_F(View, LeavesTheRunAsItIs) {
  const std::filesystem::path drive = drive_to_and_fro(street(), out / "drive");
  const std::string start = fmt::format("slam '{}' --deterministic --out ", drive.string());
  ASSERT_EQ(test::run_penumbra(fmt::format("{} '{}'", start, (out / "plain").string())).exit_code, 0);

  test::ProgramResult result;
  std::thread program([&] {
    // What it says is read while it runs.
    result = test::run_penumbra(fmt::format("{} '{}' --view=0 2>'{}' && echo done", start,
                                            (out / "viewed").string(), (out / "log").string()));
  });
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  int its_port = 0;
  json last;
  while (std::chrono::steady_clock::now() < deadline && !last.contains("run")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (its_port == 0) {
      std::ifstream log(out / "log");
      const std::string text{std::istreambuf_iterator<char>(log), {}};
      const std::size_t at = text.find("http://127.0.0.1:"), end = text.find("/\n", at + 7);
      if (at != text.npos && end != text.npos) its_port = port_of(text.substr(at, end - at));
    } else {
      const Reply state = get(its_port, "/state.json");
      if (state.status != 200) break;  // it has ended
      if (json::parse(state.body)["finished"]) last = json::parse(get(its_port, "/report.json").body);
    }
  }
  program.join();
  EXPECT_EQ(result.exit_code, 0) << test::read_file(out / "log");
  ASSERT_TRUE(last.contains("run")) << test::read_file(out / "log");
  EXPECT_EQ(last["run"], test::read_json(out / "viewed/run.json"));
  for (const char* file : {"trajectory_kitti.txt", "trajectory_tum.txt", "map.ply"}) {
    EXPECT_EQ(test::read_file(out / "plain" / file), test::read_file(out / "viewed" / file)) << file;
  }
  EXPECT_FALSE(Connection(its_port).is_connected());
  // Nobody looks: nobody is waited for.
  EXPECT_EQ(test::run_penumbra(fmt::format("{} '{}' --view=0", start, (out / "alone").string())).exit_code,
            0);
}

}  // namespace
}  // namespace penumbra
