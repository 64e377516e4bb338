#include "vrml/json/reader.h"

#include "vrml/json/members.h"
#include "vrml/syntax/tokens/text_pieces.h"

#include <string>

namespace gs::vrml::json {

struct Reader::State {
  State(SceneGraph& scene, Diagnostics& diagnostics)
      : sink(scene, diagnostics), members(sink), pieces(scene.budget()) {}

  std::size_t read(std::string_view window, bool last);
  void stop(std::string_view problem);

  SceneSink sink;
  MemberReader members;
  TextPieces pieces;
  bool started = false, stopped = false;
  ParseOutcome outcome = ParseOutcome::complete;
};

// Reads complete tokens. Returns the number of bytes read.
std::size_t Reader::State::read(std::string_view window, bool last) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (stopped) return window.size();
  std::size_t begin = 0;
  if (!started) {
    if (window.size() < kMark.size() && !last) return 0;
    started = true;
    if (window.starts_with(kMark)) begin = kMark.size();
  }
  Lexer& lexer = members.lexer();
  const char* const end = window.data() + window.size();
  lexer.set_window(window.data() + begin, end, last);
  for (;;) {
    if (sink.limits().is_exhausted(lexer.location())) {
      stopped = true;
      outcome = ParseOutcome::truncated;
      break;
    }
    const Lexer::Position start = lexer.position();
    const Progress progress = members.step();
    if (progress == Progress::done) continue;
    if (progress == Progress::need_more) lexer.go_back(start);
    break;
  }
  return static_cast<std::size_t>(lexer.unread() - window.data());
}

Reader::Reader(SceneGraph& scene, Diagnostics& diagnostics) : state_(std::make_unique<State>(scene, diagnostics)) {}
Reader::~Reader() = default;

void Reader::push(std::string_view piece) {
  State& state = *state_;
  if (state.stopped) return;
  if (state.pieces.push(piece, [&](std::string_view window) { return state.read(window, false); })) return;
  state.sink.problems().error(state.members.lexer().location(),
                              state.sink.scene().budget()->refusal(Resource::nodes) + "; skipped the rest of the file");
  state.stopped = true;
  state.outcome = ParseOutcome::truncated;
}

ParseOutcome Reader::finish() {
  State& state = *state_;
  if (!state.stopped) (void)state.read(state.pieces.rest(), true);
  if (!state.stopped && state.members.depth() > 1) {
    state.sink.problems().error(state.members.open_location(),
                                "the file ends inside the object or array that begins here");
    state.outcome = ParseOutcome::truncated;
  }
  state.members.builder().finish();
  if (!state.members.builder().is_x3d()) {
    if (state.outcome == ParseOutcome::complete) state.sink.problems().error({}, "the file has no member \"X3D\"");
    state.outcome = ParseOutcome::refused;
  }
  return state.outcome;
}

std::vector<NodeId> Reader::open_nodes() const { return state_->members.builder().open_nodes(); }

}  // namespace gs::vrml::json
