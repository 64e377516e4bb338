#include "app/session/session.h"
#include "app/streams/load_ledger.h"
#include "app/streams/stream_feed.h"

#include <algorithm>
#include <utility>

// Viewports of a session: how they share the window, memory and bandwidth.
namespace gs::app {

std::vector<Viewport> Session::places() const { return arrange(panes_.split(), area_); }

void Session::choose_layout(ViewportLayout layout) { change_split(split_of(layout, panes_.active())); }

void Session::change_split(SplitTree split) {
  router_.release();
  leave_world();
  panes_.set_split(std::move(split));
  if (linked_) panes_.link(panes_.active());
  frame_.news = true;
}

void Session::move_divider(const SplitDivider& divider, int place, int least, bool ended) {
  panes_.set_shape(with_divider_at(panes_.split(), divider, area_, place, least));
  frame_.changed = true;
  frame_.news = frame_.news || ended;
}

void Session::serve(const PaneRequest& request) {
  using Kind = PaneRequest::Kind;
  if (request.pane >= kMostViewports || !has_pane(panes_.split(), request.pane)) return;
  Pane& pane = panes_.at(request.pane);
  frame_.changed = true;
  frame_.news = frame_.news || (request.kind != Kind::weigh && request.kind != Kind::limit);
  switch (request.kind) {
    case Kind::split_right:
    case Kind::split_below:
      return split_viewport(request.pane, request.kind == Kind::split_right ? SplitAxis::columns : SplitAxis::rows);
    case Kind::maximise:
      activate(request.pane);
      return change_split(with_maximised(panes_.split(), request.pane));
    case Kind::swap:
      return change_split(with_swapped(panes_.split(), request.pane, request.other));
    case Kind::even_out:
      return change_split(evened_out(panes_.split()));
    case Kind::close:
      return close_viewport(request.pane);
    case Kind::weigh:
      pane.weight = std::clamp(request.weight, Pane::kLeastWeight, Pane::kMostWeight);
      return;
    case Kind::limit:
      pane.rate = request.rate;
      return;
    case Kind::open_again:
      if (pane.failure) open_in(request.pane, std::string(pane.failure->path));
      return;
    case Kind::dismiss:
      pane.failure.reset();
      return;
  }
}

void Session::split_viewport(std::size_t pane, SplitAxis axis) {
  panes_.set_shape(resolved(panes_.split(), area_));
  if (!panes_.split_pane(pane, axis))
    return tell("The window can have at most " + std::to_string(kMostViewports) + " viewports", false);
  forget(panes_.active());
  change_split(panes_.split());
}

void Session::close_viewport(std::size_t pane) {
  leave_world();
  if (!panes_.close(pane)) return;
  forget(pane);
  change_split(panes_.split());
}

// Removes the state of the former viewport with this number.
void Session::forget(std::size_t pane) {
  histories_[pane] = {};
  returning_.erase(pane);
  for (const DocumentList::Entry& entry : panes_.documents().entries())
    if (entry.document)
      for (const auto& feed : entry.document->world.feeds) feed->forget(static_cast<std::uint32_t>(pane));
  if (leader_ == pane) leader_ = panes_.active();
}

void Session::open_in(std::size_t pane, const std::string& path) {
  frame_.files_chosen = true;
  const std::vector<std::string> places = places_of({path});
  if (places.empty()) return;
  load_.allowed.insert(load_.allowed.end(), places.begin(), places.end());
  panes_.show_in(pane, places.front());
}

void Session::restore_split(const SplitTree& split, const std::map<std::size_t, std::string>& files,
                            const std::map<std::size_t, double>& weights) {
  change_split(split);
  for (const std::size_t pane : panes_of(split)) {
    if (const auto weight = weights.find(pane); weight != weights.end())
      panes_.at(pane).weight = std::clamp(weight->second, Pane::kLeastWeight, Pane::kMostWeight);
    if (const auto file = files.find(pane); file != files.end()) open_in(pane, file->second);
  }
}

double Session::reading_share(std::size_t pane) const {
  double all = 0, own = 0;
  for (const std::size_t i : panes_.visible()) {
    if (!reads(i)) continue;
    all += panes_.at(i).weight;
    if (i == pane) own = panes_.at(i).weight;
  }
  return all > 0 ? own / all : 0;
}

std::uint64_t Session::rate_of(std::size_t pane) const { return panes_.at(pane).rate.value_or(load_.rate); }

// Limits the bandwidth of each world to the highest limit of the viewports that show it.
void Session::limit_reading() {
  for (const Loads& one : loads()) {
    std::optional<std::uint64_t> rate;
    for (const std::size_t i : panes_.visible()) {
      const Pane& pane = panes_.at(i);
      if (pane.wanted != one.path && pane.shown != one.path) continue;
      const std::uint64_t own = rate_of(i);
      rate = own == 0 || rate == 0 ? 0 : std::max(rate.value_or(0), own);
    }
    if (rate) one.ledger->set_rate(*rate);
  }
}

std::uint64_t Session::received(std::size_t pane) const {
  const std::string& path = panes_.at(pane).wanted;
  std::uint64_t bytes = 0;
  for (const Loads& one : loads())
    if (one.path == path) bytes += one.ledger->received();
  return bytes;
}

// Gives streams a bandwidth share by the weight of their viewports.
void Session::weigh_streams() {
  double most = 0;
  for (const std::size_t i : panes_.visible())
    if (reads(i)) most = std::max(most, panes_.at(i).weight);
  if (most <= 0) return;
  std::map<const Document*, double> weights;  // max weight of the viewports that show it
  for (const std::size_t i : panes_.visible())
    if (const View* seen = panes_.at(i).view()) {
      double& weight = weights[seen->document.get()];
      weight = std::max(weight, std::min(panes_.at(i).weight / most, 1.0));
    }
  for (const auto& [document, weight] : weights)
    for (const auto& feed : document->world.feeds) feed->set_weight(weight);
}

// Returns true if a viewport receives data over the network, or may still do so.
bool Session::reads(std::size_t pane) const {
  if (panes_.loading(pane)) return true;
  const View* seen = panes_.at(pane).view();
  return seen && std::any_of(seen->document->world.feeds.begin(), seen->document->world.feeds.end(),
                             [](const auto& feed) { return feed->reading(); });
}

// Runs an action about viewports. Returns false for all other actions.
bool Session::run_in_panes(Action action) {
  using Kind = PaneRequest::Kind;
  const std::size_t active = panes_.active();
  const SplitTree& split = panes_.split();
  const auto ask = [&](Kind kind, std::size_t other = 0) {
    serve(PaneRequest{kind, active, other, 1});
    return true;
  };
  switch (action) {
    case Action::next_layout:
      choose_layout(next_layout(layout_of(split).value_or(ViewportLayout::four)));
      return true;
    case Action::viewport_1:
    case Action::viewport_2:
    case Action::viewport_3:
    case Action::viewport_4:
      activate(static_cast<std::size_t>(action) - static_cast<std::size_t>(Action::viewport_1));
      return true;
    case Action::next_pane:
    case Action::previous_pane:
      activate(next_pane(split, active, action == Action::next_pane ? 1 : -1));
      return true;
    case Action::split_right:
      if (options_.simulated) return false;
      return ask(Kind::split_right);
    case Action::split_below:
      if (options_.simulated) return false;
      return ask(Kind::split_below);
    case Action::maximise:
      return ask(Kind::maximise);
    case Action::swap_viewports:
      return ask(Kind::swap, next_pane(split, active, 1));
    case Action::even_out:
      return ask(Kind::even_out);
    case Action::close_viewport:
      return ask(Kind::close);
    case Action::link:
      toggle_link();
      return true;
    default:
      return false;
  }
}

void Session::activate(std::size_t pane) {
  const std::vector<std::size_t> sight = panes_.visible();
  panes_.activate(pane);
  if (panes_.visible() != sight) router_.release();
}

void Session::toggle_link() {
  linked_ = !linked_;
  if (linked_) panes_.link(panes_.active());
  tell(linked_ ? "Viewports linked" : "Viewports not linked", false);
}

}  // namespace gs::app
