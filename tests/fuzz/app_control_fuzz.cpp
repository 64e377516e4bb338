// Fuzzes messages of control clients, one message per line. All answers must be JSON. A value that was written must
// read back equal.
#include "app/control/control.h"
#include "app/session/session.h"
#include "tests/app/control/queued_channel.h"
#include "tests/fuzz/app_targets.h"
#include "vrml/syntax/parser.h"

#include <nlohmann/json.hpp>

#include <deque>
#include <memory>
#include <string>

using namespace gs::app;

namespace gs::fuzz {
namespace {

class Lines final : public QueuedChannel {
 public:
  void send(std::uint64_t, std::string message) override {
    require(!check_json(message));
    answered = answered || message.find("\"result\"") != std::string::npos;
  }

  bool answered = false;
};

constexpr char kWorld[] =
    "#VRML V2.0 utf8\nDEF B Transform { children Shape { geometry DEF G IndexedFaceSet { coord DEF C Coordinate {} } } "
    "}"
    "DEF T TimeSensor { loop TRUE } DEF I PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0 1 1 1 ] }"
    "DEF V Viewpoint { description \"v\" } DEF P PixelTexture {} ROUTE T.fraction_changed TO I.set_fraction "
    "ROUTE I.value_changed TO B.translation";

LoadedWorld small_world() {
  LoadedWorld world;
  Limits limits;
  limits.memory = std::size_t{16} << 20;
  world.scene = std::make_unique<vrml::SceneGraph>("fuzz.wrl", limits);
  Diagnostics diagnostics;
  (void)vrml::parse(kWorld, *world.scene, diagnostics);
  return world;
}

}  // namespace

bool run_control_messages(std::span<const std::byte> bytes) {
  Lines lines;
  Session session({{}, {}, {}, true}, {}, [] {});
  Control control(lines, [] {});
  const std::shared_ptr<Document> document = hold_world(small_world());
  document->runtime->programs().set_settings({0.1, true});
  begin_world(*document, 1000);
  session.readers().show(document);
  session.add_extension(control);
  SessionInput input;
  input.area = Viewport{0, 0, 64, 64};
  double now = 1000;
  (void)session.step(now, input);
  std::string_view text = text_of(bytes);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    // nlohmann::json also accepts a byte order mark and lists of any depth, and it ends at a null character.
    const bool unusual = line.starts_with('\xef') || line.find('\0') != std::string_view::npos;
    if (line.size() <= 64 && !unusual && nlohmann::json::accept(line)) require(!check_json(line));
    lines.news.push_back({1, line == "left", std::string(line)});
    now += 0.1;
    while (!lines.news.empty()) (void)session.step(now, input);
  }
  session.remove_extension(control);
  return lines.answered;
}

}  // namespace gs::fuzz
