#include "app/streams/load_ledger.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace gs::app {

std::string_view name_of(LoadStage stage) {
  constexpr std::array<std::string_view, 5> kNames = {"waiting", "arriving", "complete", "failed", "cancelled"};
  return kNames[static_cast<std::size_t>(stage)];
}

LoadRow* LoadLedger::find(std::uint64_t number) {
  const auto row = std::lower_bound(rows_.begin(), rows_.end(), number,
                                    [](const LoadRow& one, std::uint64_t of) { return one.number < of; });
  return row == rows_.end() || row->number != number ? nullptr : &*row;
}

std::uint64_t LoadLedger::begin(std::string url, std::string kind, const vrml::Node* node) {
  const std::lock_guard lock(mutex_);
  if (rows_.size() >= kMax) {
    const auto old = std::find_if(rows_.begin(), rows_.end(), [](const LoadRow& one) { return one.ended.has_value(); });
    if (old == rows_.end()) return 0;
    rows_.erase(old);
  }
  LoadRow row;
  row.number = ++numbers_;
  row.url = std::move(url);
  row.kind = std::move(kind);
  row.node = node;
  row.began = now();
  rows_.push_back(std::move(row));
  return numbers_;
}

void LoadLedger::seek(std::uint64_t number, std::string url, std::string kind) {
  const std::lock_guard lock(mutex_);
  LoadRow* const row = find(number);
  if (!row) return;
  row->url = std::move(url);
  row->kind = std::move(kind);
  row->stage = LoadStage::waiting;
  row->received = 0;
  row->total.reset();
}

void LoadLedger::receive(std::uint64_t number, std::uint64_t bytes, std::optional<std::uint64_t> total) {
  const std::lock_guard lock(mutex_);
  LoadRow* const row = find(number);
  if (!row) return;
  if (row->kind != "file" && row->kind != "data") received_ += bytes;
  if (row->ended) return;
  row->stage = LoadStage::arriving;
  row->received += bytes;
  if (total) row->total = total;
  if (!row->by_view || !row->total || row->received < *row->total) return;
  row->stage = LoadStage::whole;
  row->ended = now();
}

void LoadLedger::count_cells(std::uint64_t number, const CellCounts& counts) {
  const std::lock_guard lock(mutex_);
  LoadRow* const row = find(number);
  if (!row) return;
  row->cells = counts;
}

void LoadLedger::follow(std::uint64_t number, const StreamFeed* feed, bool by_view) {
  const std::lock_guard lock(mutex_);
  LoadRow* const row = find(number);
  if (!row) return;
  row->by_view = by_view;
  row->feed = feed;
}

void LoadLedger::show(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  LoadRow* const row = find(number);
  if (row && !row->first_picture) row->first_picture = now() - row->began;
}

void LoadLedger::end(std::uint64_t number, LoadStage stage, std::string why) {
  const std::lock_guard lock(mutex_);
  LoadRow* const row = find(number);
  if (!row || row->ended) return;
  row->stage = stage;
  row->why = std::move(why);
  row->ended = now();
}

std::vector<std::uint64_t> LoadLedger::take_cancelled() {
  const std::lock_guard lock(mutex_);
  return std::exchange(cancelled_, {});
}

void LoadLedger::set_wake(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  wake_ = std::move(wake);
}

std::vector<LoadRow> LoadLedger::rows() const {
  const std::lock_guard lock(mutex_);
  return {rows_.begin(), rows_.end()};
}

void LoadLedger::cancel(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  const LoadRow* const row = find(number);
  if (!row || row->ended || cancelled_.size() >= kMax) return;
  cancelled_.push_back(number);
  if (wake_) wake_();
}

std::uint64_t LoadLedger::received() const {
  const std::lock_guard lock(mutex_);
  return received_;
}

void LoadLedger::set_rate(std::uint64_t bits_a_second) {
  const std::lock_guard lock(mutex_);
  if (rate_ == bits_a_second) return;
  rate_ = bits_a_second;
  if (wake_) wake_();
}

std::optional<std::uint64_t> LoadLedger::rate() const {
  const std::lock_guard lock(mutex_);
  return rate_;
}

}  // namespace gs::app
