#include "app/script/boundary/world_view.h"

namespace gs::app::script {
namespace {

constexpr std::size_t kMaxKeptValues = 4096;

// Reports whether a question may change what earlier questions have answered.
bool changes_world(Ask ask) {
  switch (ask) {
    case Ask::describe:
    case Ask::may_read:
    case Ask::read:
    case Ask::name:
    case Ask::print_nodes:
    case Ask::is_pressed:
    case Ask::browser:
      return false;
    default:
      return true;
  }
}

}  // namespace

void WorldView::begin_function(const std::vector<std::uint64_t>& gone) {
  gone_.insert(gone.begin(), gone.end());
  if (!gone.empty()) std::erase_if(held_, [&](const auto& one) { return gone_.contains(one.first.scene); });
  values_.clear();
  browser_ = nullptr;
}

Answer WorldView::ask(const Question& question) {
  if (changes_world(question.ask)) {
    values_.clear();
    browser_ = nullptr;
  }
  return world_.ask(question);
}

std::optional<vrml::FieldValue> WorldView::read(const NodeRef& node, std::uint32_t place) {
  const PlaceRef key{node, place};
  if (const auto known = values_.find(key); known != values_.end()) return known->second;
  Question question;
  question.ask = Ask::read;
  question.node = node;
  question.place = place;
  Answer answer = ask(question);
  std::optional<vrml::FieldValue> value;
  if (answer.good) value = std::move(answer.value);
  if (values_.size() < kMaxKeptValues) values_.emplace(key, value);
  return value;
}

const BrowserFacts& WorldView::browser() {
  static const BrowserFacts nothing;
  if (!browser_) {
    Question question;
    question.ask = Ask::browser;
    browser_ = ask(question).browser;
  }
  return browser_ ? *browser_ : nothing;
}

void WorldView::hold(const NodeRef& node) {
  if (++held_[node] == 1) tell({Notice::Kind::hold, node});
}

void WorldView::release(const NodeRef& node) {
  const auto held = held_.find(node);
  if (held == held_.end() || --held->second != 0) return;
  held_.erase(held);
  tell({Notice::Kind::release, node});
}

void WorldView::print(std::string text) {
  Notice notice{Notice::Kind::print};
  notice.text = std::move(text);
  tell(notice);
}

void WorldView::report(Severity severity, std::string text, std::optional<Diagnostic> at) {
  Notice notice{Notice::Kind::report};
  notice.severity = severity;
  notice.text = std::move(text);
  notice.at = std::move(at);
  tell(notice);
}

}  // namespace gs::app::script
