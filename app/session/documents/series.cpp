#include "app/session/documents/series.h"

#include "app/base/numbered_files.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr double kStepRate = 10;  // steps per second, as for volumes

}  // namespace

std::string SeriesList::file_of(const std::string& name) {
  if (const Series* known = find(name)) return known->files[known->wanted];
  auto files = file_series(name);
  if (!files || files->empty()) return name;
  Series& series = series_[name];
  series.files = std::move(*files);
  return series.files.front();
}

void SeriesList::set_steps(const std::string& name, const std::vector<double>& times, std::size_t shown) {
  if (times.size() < 2 || shown >= times.size()) return;
  const auto known = series_.find(name);
  if (known != series_.end() && (known->second.times.empty() || known->second.times == times)) return;
  Series series;
  series.files.assign(times.size(), name);
  series.times = times;
  series.wanted = series.shown = shown;
  series.rate = kStepRate;
  series_[name] = std::move(series);
}

std::optional<std::size_t> SeriesList::step_of(const std::string& name) const {
  const Series* const series = find(name);
  return series && !series->times.empty() ? std::optional(series->wanted) : std::nullopt;
}

bool SeriesList::refresh(const std::string& name, bool newest) {
  Series* const series = find(name);
  auto files = series ? file_series(name) : std::nullopt;
  if (!files || files->size() <= series->files.size()) return false;
  series->files = std::move(*files);
  if (newest && !series->playing) series->wanted = series->files.size() - 1;
  return true;
}

SeriesList::Series* SeriesList::find(const std::string& name) {
  const auto found = series_.find(name);
  return found == series_.end() ? nullptr : &found->second;
}

const SeriesList::Series* SeriesList::find(const std::string& name) const {
  const auto found = series_.find(name);
  return found == series_.end() ? nullptr : &found->second;
}

bool SeriesList::holds_back(const std::string& name, double now) const {
  const Series* series = find(name);
  return series && now < series->due;
}

bool SeriesList::arrived(const std::string& name, double now) {
  Series* series = find(name);
  if (!series) return false;
  series->shown = series->wanted;
  if (!series->playing || series->files.size() < 2) return false;
  series->wanted = (series->shown + 1) % series->files.size();
  // The next file is due one interval later, but never in the past: a late file does not shorten the display of later
  // ones.
  series->due = std::max(series->due + 1 / series->rate, now);
  return true;
}

bool SeriesList::play(const std::string& name, bool on, double now) {
  Series* series = find(name);
  if (!series || series->playing == on) return false;
  series->playing = on;
  if (!on || series->files.size() < 2) return false;
  series->due = now + 1 / series->rate;
  return std::exchange(series->wanted, (series->shown + 1) % series->files.size()) != series->wanted;
}

bool SeriesList::show(const std::string& name, std::size_t file, double now) {
  Series* series = find(name);
  if (!series || file >= series->files.size()) return false;
  series->playing = false;
  series->due = now;
  return std::exchange(series->wanted, file) != file || series->shown != file;
}

void SeriesList::set_rate(const std::string& name, double rate) {
  constexpr double kSlowest = 0.01, kFastest = 240;
  if (Series* series = find(name); series && rate == rate) series->rate = std::clamp(rate, kSlowest, kFastest);
}

std::optional<double> SeriesList::next_due() const {
  std::optional<double> next;
  for (const auto& [name, series] : series_)
    if (series.playing) next = std::min(next.value_or(series.due), series.due);
  return next;
}

}  // namespace gs::app
