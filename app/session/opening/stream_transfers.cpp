#include "app/session/opening/stream_transfers.h"

#include "app/loading/fetch/importance.h"
#include "app/streams/load_ledger.h"
#include "app/streams/stream_feed.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>

namespace gs::app {
namespace {

constexpr double kBetweenPriorities = 0.5;

}  // namespace

void StreamTransfers::prioritize() {
  const View* seen = viewports_.view();
  if (!seen || !seen->document->reader || seen->document->arriving.waiting == 0) return;
  if (step_.now < next_priorities_) return;
  const double started = world_time();
  const auto wanted = seen->document->reader->wanted();
  if (wanted.empty()) return;
  seen->document->reader->prioritize(
      importance_of(*seen->document->world.scene, wanted, seen->navigation.pose.position));
  next_priorities_ = step_.now + std::max(kBetweenPriorities, 20 * (world_time() - started));
}

bool StreamTransfers::feed() {
  bool any = false;
  for (const std::size_t i : viewports_.panes().visible())
    if (const View* seen = viewports_.panes().at(i).view())
      for (const auto& feed : seen->document->world.feeds) {
        any = feed->apply() || any;
        if (const std::string problem = feed->take_problem(); !problem.empty()) step_.notify(problem, true);
      }
  return any;
}

void StreamTransfers::request() {
  weigh();
  for (const std::size_t i : viewports_.panes().visible())
    if (const View* seen = viewports_.panes().at(i).view())
      for (const auto& feed : seen->document->world.feeds) feed->ask();
}

double StreamTransfers::reading_share(std::size_t pane) const {
  const Panes& panes = viewports_.panes();
  double all = 0, own = 0;
  for (const std::size_t i : panes.visible()) {
    if (!reads(i)) continue;
    all += panes.at(i).weight;
    if (i == pane) own = panes.at(i).weight;
  }
  return all > 0 ? own / all : 0;
}

std::uint64_t StreamTransfers::rate_of(std::size_t pane) const {
  return viewports_.panes().at(pane).rate.value_or(load_.rate);
}

void StreamTransfers::limit_rates() {
  for (const DocumentReaders::Loads& one : readers_.loads()) {
    std::optional<std::uint64_t> rate;
    for (const std::size_t i : viewports_.panes().visible()) {
      const Pane& pane = viewports_.panes().at(i);
      if (pane.wanted != one.path && pane.shown != one.path) continue;
      const std::uint64_t own = rate_of(i);
      rate = own == 0 || rate == 0 ? 0 : std::max(rate.value_or(0), own);
    }
    if (rate) one.ledger->set_rate(*rate);
  }
}

std::uint64_t StreamTransfers::received(std::size_t pane) const {
  const std::string& path = viewports_.panes().at(pane).wanted;
  std::uint64_t bytes = 0;
  for (const DocumentReaders::Loads& one : readers_.loads())
    if (one.path == path) bytes += one.ledger->received();
  return bytes;
}

// Sets the weight of each stream by the weights of the viewports that show it.
void StreamTransfers::weigh() {
  const Panes& panes = viewports_.panes();
  double most = 0;
  for (const std::size_t i : panes.visible())
    if (reads(i)) most = std::max(most, panes.at(i).weight);
  if (most <= 0) return;
  std::map<const Document*, double> weights;  // max weight of the viewports that show it, relative to all viewports
  for (const std::size_t i : panes.visible())
    if (const View* seen = panes.at(i).view()) {
      double& weight = weights[seen->document.get()];
      weight = std::max(weight, std::min(panes.at(i).weight / most, 1.0));
    }
  for (const auto& [document, weight] : weights)
    for (const auto& feed : document->world.feeds) feed->set_weight(weight);
}

// Returns true if a viewport is receiving network data or still expects some.
bool StreamTransfers::reads(std::size_t pane) const {
  if (viewports_.panes().loading(pane)) return true;
  const View* seen = viewports_.panes().at(pane).view();
  return seen && std::any_of(seen->document->world.feeds.begin(), seen->document->world.feeds.end(),
                             [](const auto& feed) { return feed->reading(); });
}

}  // namespace gs::app
