#include "app/inspect/stream_list.h"

#include "app/session/session.h"
#include "app/streams/stream_feed.h"

#include <algorithm>
#include <cstdio>

namespace gs::app {
namespace {

std::string count_text(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// Returns text about the state of a QNV stream that is being loaded.
std::string detail_of(const Document& document, const LoadRow& load) {
  for (const auto& feed : document.world.feeds) {
    if (feed.get() != load.feed || !(feed->stream() || feed->splats())) continue;
    const qnv::SplatStatistics splats = feed->splats() ? feed->splats()->statistics() : qnv::SplatStatistics{};
    const qnv::LodStatistics discs = feed->stream() ? feed->stream()->statistics() : qnv::LodStatistics{};
    std::string text = count_text(splats.clusters + discs.clusters, "part") + " received, " +
                       count_text(splats.cached_splats + discs.cached_discs, "vector") + " shown";
    const std::size_t wanted = feed->requests()->wanted().size();
    if (load.by_view && !load.ended)
      text += wanted > 0 ? ", " + count_text(wanted, "part") + " wanted" : ", fine enough";
    return text;
  }
  return {};
}

// Requests the url of a row's node again. Compares only the address of the node, which may no longer exist.
void send_again(Session& session, const StreamList::Row& row) {
  const std::shared_ptr<Document>& document = row.document;
  if (document && document->runtime && row.load.node) {
    vrml::Execution& execution = document->runtime->execution();
    std::vector<const vrml::SceneGraph*> scenes{&execution.scenes().root()};
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      for (const auto& [place, content] : scenes[i]->inlines().all())
        if (content && execution.scenes().has(content.get())) scenes.push_back(content.get());
      for (std::uint32_t place = 1; place <= scenes[i]->nodes().count(); ++place) {
        const vrml::Node& node = scenes[i]->nodes().at(place);
        const vrml::NodeId id = scenes[i]->nodes().id_at(place);
        if (&node != row.load.node || !scenes[i]->contains(id)) continue;
        execution.cascade().begin_update();
        for (const vrml::InterfaceDeclaration* const url : node.type->url_fields())
          (void)execution.cascade().post(*scenes[i], id, *url, node.values[url->slot]);
        execution.cascade().drain();
        return;
      }
    }
  }
  if (session.panes().documents().find(row.world))
    session.panes().documents().reload_unedited(row.world);
  else
    session.opening().open_files({row.world});
}

}  // namespace

bool RateHistory::note(std::uint64_t bytes, double now) {
  if (!bytes_) {
    bytes_ = bytes;
    at_ = now;
    return false;
  }
  const double seconds = now - at_;
  if (seconds < kSeconds) return false;
  // If the total is smaller than before, the download has restarted at 0.
  const std::uint64_t more = bytes >= *bytes_ ? bytes - *bytes_ : bytes;
  const auto rate = static_cast<float>(static_cast<double>(more) * 8 / seconds);
  // After a pause, several samples are due. All get the average rate.
  const auto times = static_cast<std::size_t>(std::min(seconds / kSeconds, static_cast<double>(kSamples)));
  for (std::size_t i = 0; i < times; ++i) rates_[count_++ % kSamples] = rate;
  bytes_ = bytes;
  at_ = now;
  return true;
}

double RateHistory::rate() const {
  constexpr std::size_t kLast = static_cast<std::size_t>(1 / kSeconds);
  const std::size_t count = std::min({count_, kLast, kSamples});
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += rates_[(count_ - 1 - i) % kSamples];
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

std::vector<float> RateHistory::samples() const {
  const std::size_t count = std::min(count_, kSamples);
  std::vector<float> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = rates_[(count_ - count + i) % kSamples];
  return result;
}

void StreamList::send_retries(Session& session) {
  for (const Row& row : std::exchange(retried_, {})) send_again(session, row);
}

void StreamList::clear() {
  rows_.clear();
  histories_.clear();
  next_.reset();
}

void StreamList::refresh(const DocumentReaders& readers, double now) {
  if (next_ && now < *next_) return;
  next_ = now + RateHistory::kSeconds;
  rows_.clear();
  std::map<Key, RateHistory> kept;
  for (const DocumentReaders::Loads& loads : readers.loads())
    for (LoadRow& load : loads.ledger->rows()) {
      Row row;
      const Key key{loads.ledger.get(), load.number};
      RateHistory& history = kept.emplace(key, std::move(histories_[key])).first->second;
      (void)history.note(load.received, now);
      row.rate = load.ended ? 0 : history.rate();
      row.rates = history.samples();
      if (load.feed && loads.document) row.detail = detail_of(*loads.document, load);
      row.load = std::move(load);
      row.world = loads.path;
      row.ledger = loads.ledger;
      row.document = loads.document;
      rows_.push_back(std::move(row));
    }
  histories_ = std::move(kept);
  std::stable_partition(rows_.begin(), rows_.end(), [](const Row& row) { return !row.ended(); });
}

std::size_t StreamList::arriving() const {
  return static_cast<std::size_t>(
      std::count_if(rows_.begin(), rows_.end(), [](const Row& row) { return !row.ended(); }));
}

std::string readable_rate(double bits) {
  const char* const units[] = {"bit/s", "kbit/s", "Mbit/s", "Gbit/s"};
  std::size_t unit = 0;
  for (; bits >= 1000 && unit + 1 < std::size(units); ++unit) bits /= 1000;
  char text[48];
  std::snprintf(text, sizeof text, unit == 0 || bits >= 100 ? "%.0f %s" : "%.1f %s", bits, units[unit]);
  return text;
}

std::optional<double> loss_of(const LoadRow& row) {
  const std::uint64_t sent = row.cells.datagrams + row.cells.lost;
  return sent == 0 ? std::nullopt : std::optional(static_cast<double>(row.cells.lost) / static_cast<double>(sent));
}

std::string state_of(const LoadRow& row) {
  std::string text(name_of(row.stage));
  if (const double loss = loss_of(row).value_or(0); row.stage == LoadStage::whole && row.cells.missing && loss > 0) {
    char percent[32];
    std::snprintf(percent, sizeof percent, loss < 0.01 ? ", %.1f %% lost" : ", %.0f %% lost", loss * 100);
    text += percent;
  }
  return text;
}

std::string slowness_of(const LoadRow& row) {
  constexpr double kSlow = 0.9;  // the server always sends a little less than it granted
  const CellCounts& cells = row.cells;
  if (row.ended || !(cells.loss_events > 0) || cells.rate == 0 ||
      static_cast<double>(cells.rate) >= kSlow * static_cast<double>(cells.granted))
    return {};
  return "slowed by losses: " + readable_rate(static_cast<double>(cells.rate)) + " of " +
         readable_rate(static_cast<double>(cells.granted));
}

}  // namespace gs::app
