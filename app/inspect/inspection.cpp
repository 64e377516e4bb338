#include "app/inspect/inspection.h"

#include "app/inspect/field_edits.h"
#include "app/inspect/field_values.h"
#include "app/script/run_time_nodes.h"
#include "app/session/opening/links.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kWork = 200'000;      // max nodes visited per step
constexpr std::size_t kMostEdits = 10'000;  // max pending edits
constexpr double kBetweenPictures = 0.1;    // min seconds between pictures of continuous changes
constexpr double kLit = 0.6;                // seconds of highlight after an event

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
  routes_.refresh(nullptr);
  names_.reset();
  selected_ = bounds_of_ = {};
  bounds_ = {};
  marks_.clear();
  edits_.clear();
  revealed_.reset();
  match_.reset();
  reveal_ = fly_ = false;
  document_ = document;
  world_ = document ? &document->runtime->execution() : nullptr;
  if (!world_) return;
  outline_.set_world(world_, &index_);
}

bool Inspection::act(Session& session) {
  enter(wants_.world() || picking_ || selected_ ? document_of(session) : nullptr);
  if (!retried_.empty())
    for (const StreamList::Row& row : std::exchange(retried_, {})) send_again(session, row);
  if (!world_) {
    if (!entered_.empty()) console_.answer("no world is running", true);
    entered_.clear();
    return false;
  }
  if (selected_ && !is_in(*world_, selected_)) select({}, false);
  watch_.watch(wants_.inspector || wants_.routes ? world_ : nullptr);
  const bool learns = wants_.tree || selected_;
  if (learns && index_.world() != world_) index_.set_world(world_);
  if (!learns && index_.world()) index_.set_world(nullptr);
  more_ = learns && index_.go_on(kWork, world_->now());
  bool changed = deliver();
  for (const std::string& line : std::exchange(entered_, {})) {
    const NodeAt script = console_script();
    const ScriptRunner::Evaluation answer =
        document_->runtime->programs().evaluate(script ? *script.scene : world_->root(), script.id, line);
    console_.answer(answer.text, answer.failed);
    changed = true;
  }
  if (std::exchange(fly_, false)) session.camera().fly_to(bounds_);
  if (watch_.take_news()) news_ = true;
  if (wants_.console && console_.take(session.log(), document_->world.path)) news_ = true;
  return changed;
}

bool Inspection::deliver() {
  if (edits_.empty()) return false;
  world_->begin_update();
  for (Edit& one : std::exchange(edits_, {}))
    if (is_in(*world_, one.node)) (void)world_->post(*one.node.scene, one.node.id, *one.event_in, std::move(one.value));
  world_->end_update();
  return true;
}

bool Inspection::busy() const { return more_ || fly_ || !edits_.empty() || !entered_.empty() || !retried_.empty(); }

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
    streams_.refresh(session, now);
  else if (!streams_.rows().empty())
    streams_.clear();
  marks_.clear();
  if (document_ && document_ != document_of(session)) enter(nullptr);
  if (!world_) return;
  if (selected_ && !is_in(*world_, selected_)) select({}, false);
  if (wants_.tree) {
    outline_.refresh();
    if (finds_ && index_.matches() > 0) find_next(false);
    reveal_pending();
  }
  if (wants_.routes) routes_.refresh(world_, routes_only_ ? selected_ : NodeAt{});
  if (!selected_) return;
  find_bounds(*session.view(), now);
  for (const Frame::Picture& one : pictures)
    if (one.view && one.view->document == document_)
      marks_.push_back({one.place, edges_of(bounds_, one.view->navigation.pose, one.place)});
}

void Inspection::find_bounds(const View& view, double now) {
  if (bounds_of_ == selected_ && now < bounds_due_) return;
  const auto begin = world_time();
  bounds_of_ = selected_;
  std::vector<NodeAt> nodes{selected_};
  const std::vector<HeldStep> way = index_.way_to(selected_);
  for (auto step = way.rbegin(); step != way.rend(); ++step)
    if (!(step->node == selected_)) nodes.push_back(step->node);
  bounds_ = bounds_in(*view.list, nodes);
  // Limit the share of time in large worlds.
  constexpr double kShare = 30;
  bounds_due_ = now + kShare * (world_time() - begin);
}

// Selected node -----------------------------------------------------------------------------------

void Inspection::select(const NodeAt& node, bool reveal) {
  selected_ = node;
  reveal_ = reveal && static_cast<bool>(node);
  if (!node) bounds_ = {};
}

void Inspection::reveal_pending() {
  if (!reveal_) return;
  const std::vector<HeldStep> way = index_.way_to(selected_);
  if (way.empty() && !index_.complete()) return;  // not indexed yet
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
  if (!selected_ || bounds_.empty()) return false;
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

const vrml::FieldValue* Inspection::value_of(const vrml::InterfaceDeclaration& interface) const {
  return world_ && selected_ ? world_->last_value(*selected_.scene, selected_.id, interface) : nullptr;
}

std::optional<std::string> Inspection::send_text(const vrml::InterfaceDeclaration& event_in, const std::string& text) {
  if (!world_ || !selected_) return "the node no longer exists";
  // DEF names resolve in the world's main file only.
  if (vrml::holds_nodes(event_in.type) && selected_.scene != &world_->root())
    return "nodes of Inlines cannot be set to nodes here";
  if (!names_) names_ = std::make_unique<vrml::NodeNames>(world_->root());
  auto read = read_edit(*selected_.scene->node(selected_.id).type, event_in, text, *names_);
  if (auto* why = std::get_if<std::string>(&read)) return std::move(*why);
  return send(event_in, std::move(std::get<vrml::FieldValue>(read)));
}

std::optional<std::string> Inspection::send(const vrml::InterfaceDeclaration& event_in, vrml::FieldValue value) {
  if (!world_ || !selected_) return "the node no longer exists";
  if (auto why = why_not_valid(*selected_.scene->node(selected_.id).type, event_in, value)) return why;
  if (edits_.size() >= kMostEdits) return "too many changes are pending; try again";
  edits_.push_back({selected_, &event_in, std::move(value)});
  return std::nullopt;
}

std::optional<std::string> Inspection::target_of_url(const vrml::InterfaceDeclaration& url, std::size_t index) const {
  const vrml::FieldValue* const value = value_of(url);
  const auto* const urls = value ? std::get_if<vrml::MFString>(value) : nullptr;
  if (!urls || index >= urls->size() || url.slot < 0) return std::nullopt;
  const Link link = link_of({(*urls)[index].str()}, {}, selected_.scene->text_of(selected_.id, url.slot).origin());
  if (link.places.empty() || !link.places.front().problem.empty() || link.places.front().target.empty())
    return std::nullopt;
  return link.places.front().target;
}

std::optional<std::string> Inspection::send_element(const vrml::InterfaceDeclaration& event_in,
                                                    const vrml::FieldValue& list, std::size_t index,
                                                    const vrml::FieldValue& element) {
  vrml::FieldValue changed = list;
  if (!set_element(changed, index, element)) return "the element no longer exists";
  return send(event_in, std::move(changed));
}

std::optional<std::string> Inspection::send_element_text(const vrml::InterfaceDeclaration& event_in,
                                                         const vrml::FieldValue& list, std::size_t index,
                                                         const std::string& text) {
  if (!world_ || !selected_ || index >= element_count(list)) return "the element no longer exists";
  if (!names_) names_ = std::make_unique<vrml::NodeNames>(world_->root());
  const vrml::FieldType type = vrml::type_of(element_of(list, index));
  if (vrml::holds_nodes(type) && selected_.scene != &world_->root())
    return "nodes of Inlines cannot be set to nodes here";
  const auto value = read_value(text, type, *names_);
  if (!value) return "'" + text.substr(0, 80) + "' is no " + std::string(vrml::name_of(type));
  return send_element(event_in, list, index, *value);
}

// Programs and streams ----------------------------------------------------------------------------

NodeAt Inspection::console_script() const {
  if (!world_ || !selected_ || !is_in(*world_, selected_)) return {};
  const vrml::NodeId id = selected_.scene->resolve(selected_.id);
  return id && vrml::has(selected_.scene->node(id).type->role, vrml::Role::script) ? NodeAt{selected_.scene, id}
                                                                                   : NodeAt{};
}

void Inspection::evaluate(const std::string& line) {
  if (console_.enter(line)) entered_.push_back(line);
}

void Inspection::retry(const StreamList::Row& row) { retried_.push_back(row); }

// Finds the node by address only, because it may no longer exist.
void Inspection::send_again(Session& session, const StreamList::Row& row) {
  const std::shared_ptr<Document>& document = row.document;
  if (document && document->runtime && row.load.node) {
    vrml::Execution& execution = document->runtime->execution();
    std::vector<const vrml::SceneGraph*> scenes{&execution.root()};
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      for (const auto& [place, content] : scenes[i]->inlines())
        if (content && execution.has_scene(content.get())) scenes.push_back(content.get());
      for (std::uint32_t place = 1; place <= scenes[i]->node_count(); ++place) {
        const vrml::Node& node = scenes[i]->node_at(place);
        const vrml::NodeId id = scenes[i]->id_at(place);
        if (&node != row.load.node || !scenes[i]->contains(id)) continue;
        execution.begin_update();
        for (const vrml::InterfaceDeclaration* const url : node.type->url_fields())
          (void)execution.post(*scenes[i], id, *url, node.values[url->slot]);
        execution.end_update();
        return;
      }
    }
  }
  if (session.panes().documents().find(row.world))
    session.panes().reload(row.world);
  else
    session.opening().open_files({row.world});
}

}  // namespace gs::app
