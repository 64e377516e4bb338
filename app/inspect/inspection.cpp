#include "app/inspect/inspection.h"

#include "app/saving/world_text.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kWork = 200'000;    // max number of nodes to visit per step
constexpr double kBetweenPictures = 0.1;  // min seconds between two pictures while values change
constexpr double kLit = 0.6;              // seconds for which an event highlights its ROUTE

std::shared_ptr<Document> document_of(Session& session) {
  const View* const seen = session.view();
  const bool lives = seen && seen->document->runtime && seen->document->runtime->has_started();
  return lives ? seen->document : nullptr;
}

}  // namespace

// Step -------------------------------------------------------------------------------------------

void Inspection::enter(const std::shared_ptr<Document>& document) {
  if (document == document_) return;
  index_.set_world(nullptr);
  outline_.set_world(nullptr, nullptr);
  watch_.watch(nullptr);
  routes_.refresh(nullptr, {});
  editor_.set_world(nullptr);
  selected_ = {};
  mark_.clear();
  revealed_.reset();
  match_.reset();
  reveal_ = fly_ = false;
  document_ = document;
  world_ = document ? &document->runtime->execution() : nullptr;
  editor_.set_world(world_);
  if (!world_) return;
  outline_.set_world(world_, &index_);
}

bool Inspection::act(Session& session) {
  const int step = std::exchange(step_, 0);
  enter(wants_.world() || picking_ || selected_ || step != 0 ? document_of(session) : nullptr);
  streams_.send_retries(session);
  if (!world_) {
    if (!console_.take_entered().empty()) console_.answer("no world is running", true);
    return false;
  }
  if (selected_ && !is_in(*world_, selected_)) select({}, false);
  watch_.watch(wants_.inspector || wants_.routes ? world_ : nullptr);
  const bool learns = wants_.tree || selected_;
  if (learns && index_.world() != world_) index_.set_world(world_);
  if (!learns && index_.world()) index_.set_world(nullptr);
  more_ = learns && index_.go_on(kWork, world_->now());
  if (editor_.pending()) keep_source_text(*document_);
  bool changed = editor_.deliver(document_->edits);
  if (step != 0) changed = editor_.step(document_->edits, step) || changed;
  for (const std::string& line : console_.take_entered()) {
    const NodeAt script = editor_.script();
    const ScriptRunner::Evaluation answer =
        document_->runtime->programs().evaluate(script ? *script.scene : world_->scenes().root(), script.id, line);
    console_.answer(answer.text, answer.failed);
    changed = true;
  }
  if (std::exchange(fly_, false)) session.camera().fly_to(mark_.bounds());
  if (watch_.take_news()) news_ = true;
  if (wants_.console && console_.take(session.log(), document_->world.path)) news_ = true;
  return changed;
}

bool Inspection::busy() const {
  return more_ || fly_ || step_ != 0 || editor_.pending() || console_.has_entered() || streams_.has_retries();
}

std::optional<double> Inspection::next_change() const {
  const bool lit = (wants_.routes || wants_.inspector) && clock_ - last_news_ < kLit;
  if (lit || news_) return kBetweenPictures;
  return wants_.streams && streams_.arriving() > 0 ? std::optional(RateHistory::kSeconds) : std::nullopt;
}

bool Inspection::take_news(double now) {
  if (!wants_.any() || now - shown_at_ < kBetweenPictures) return false;
  const bool lit = (wants_.routes || wants_.inspector) && now - last_news_ < kLit;
  const bool measured = wants_.streams && streams_.arriving() > 0 && now - shown_at_ >= RateHistory::kSeconds;
  if (news_) last_news_ = now;
  return std::exchange(news_, false) || lit || measured;
}

// Picture -----------------------------------------------------------------------------------------

void Inspection::prepare(Session& session, std::span<const Frame::Picture> pictures, double now) {
  clock_ = shown_at_ = now;
  wants_ = std::exchange(drawn_, {});
  if (wants_.world()) enter(document_of(session));
  if (wants_.streams)
    streams_.refresh(session.readers(), now);
  else if (!streams_.rows().empty())
    streams_.clear();
  mark_.clear_outlines();
  if (document_ && document_ != document_of(session)) enter(nullptr);
  if (!world_) return;
  if (selected_ && !is_in(*world_, selected_)) select({}, false);
  if (wants_.tree) {
    outline_.refresh();
    if (finds_ && index_.matches() > 0) find_next(false);
    reveal_pending();
  }
  if (wants_.routes) routes_.refresh(world_, selected_);
  if (!selected_) return;
  mark_.find_bounds(selected_, index_, *session.view(), now);
  for (const Frame::Picture& one : pictures)
    if (one.view && one.view->document == document_) mark_.add_outline(one.place, one.view->navigation.pose);
}

// Selected node -----------------------------------------------------------------------------------

void Inspection::select(const NodeAt& node, bool reveal) {
  selected_ = node;
  editor_.select(node);
  reveal_ = reveal && static_cast<bool>(node);
  if (!node) mark_.forget_bounds();
}

void Inspection::reveal_pending() {
  if (!reveal_) return;
  const std::vector<HeldStep> way = index_.way_to(selected_);
  if (way.empty() && !index_.complete()) return;  // the node is not in the index yet
  reveal_ = false;
  revealed_ = outline_.reveal(way);
}

bool Inspection::pick(Session& session, const glm::vec2& pixel) {
  picking_ = false;
  const std::optional<Pointing::Picked> picked = session.pointing().pick_at(pixel);
  if (!picked || picked->path.empty()) return false;
  const std::shared_ptr<Document> document = document_of(session);
  const View* const seen = session.panes().at(picked->pane).view();
  if (!document || !seen || seen->document != document) return false;
  enter(document);
  select({picked->path.back().scene, picked->path.back().node}, true);
  return true;
}

bool Inspection::fly_to_selected() {
  if (!selected_ || mark_.bounds().empty()) return false;
  return fly_ = true;
}

void Inspection::find(const std::string& text) {
  index_.find(text);
  match_.reset();
  finds_ = !text.empty();
  more_ = true;
}

void Inspection::find_next(bool before) {
  finds_ = false;
  const std::size_t count = index_.matches();
  if (count == 0) return;
  const std::size_t present = match_.value_or(before ? 0 : count - 1);
  match_ = (std::min(present, count - 1) + (before ? count - 1 : 1)) % count;
  select(index_.match(*match_), true);
}

}  // namespace gs::app
