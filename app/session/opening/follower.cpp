#include "app/session/opening/follower.h"

#include "app/base/numbered_files.h"
#include "app/loading/fetch/small_request.h"
#include "app/loading/updates/live_data.h"
#include "net/base/url.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <tuple>
#include <utility>

namespace gs::app {
namespace {

bool is_on_server(const std::string& path) {
  const std::string scheme = net::parse_url(path).scheme;
  return !scheme.empty() && scheme != "file";
}

std::string stat_text(const std::string& path) {
  struct ::stat found {};
  if (::stat(path.c_str(), &found) != 0) return "-";
  return std::to_string(found.st_ino) + ' ' + std::to_string(found.st_size) + ' ' +
         std::to_string(found.st_mtim.tv_sec) + '.' + std::to_string(found.st_mtim.tv_nsec);
}

/// Returns the number of files below a folder, their size and the last change.
std::string folder_text(const std::string& path, const std::atomic<bool>& stop) {
  constexpr std::size_t kMost = 200'000;
  std::size_t count = 0;
  std::uint64_t size = 0;
  std::int64_t seconds = 0, part = 0;
  std::error_code error;
  using Walk = std::filesystem::recursive_directory_iterator;
  for (Walk walk(path, std::filesystem::directory_options::skip_permission_denied, error);
       !error && walk != Walk() && count < kMost && !stop; walk.increment(error)) {
    struct ::stat found {};
    if (::stat(walk->path().c_str(), &found) != 0) continue;
    ++count;
    size += static_cast<std::uint64_t>(found.st_size);
    std::tie(seconds, part) = std::max(
        std::tuple(seconds, part), std::tuple<std::int64_t, std::int64_t>(found.st_mtim.tv_sec, found.st_mtim.tv_nsec));
  }
  return std::to_string(count) + ' ' + std::to_string(size) + ' ' + std::to_string(seconds) + '.' +
         std::to_string(part);
}

/// Requests the first byte of a URL, and returns the validators of the answer.
std::string server_text(const std::string& url, const LoadOptions& load, const std::atomic<bool>& stop) {
  net::Request request;
  request.url = live_address(url);
  request.ranges = {{0, 1}};
  return small_request(std::move(request), true, load, stop).version;
}

}  // namespace

std::string version_of(const std::string& path, const LoadOptions& load, const std::atomic<bool>& stop) {
  if (is_on_server(path)) {
    if (load.offline) return {};
    return server_text(path, load, stop);
  }
  const net::Url url = net::parse_url(path);
  const std::string local = url.scheme == "file" ? net::path_of_url(url) : path;
  std::error_code error;
  if (std::filesystem::is_directory(local, error)) return folder_text(local, stop);
  if (const auto files = file_series(local); files && !files->empty())
    return std::to_string(files->size()) + ' ' + stat_text(files->back());
  return stat_text(local);
}

Follower::Follower(StepContext& step, SessionViewports& viewports, SeriesList& series, const LoadOptions& load,
                   std::function<void()> wake)
    : step_(step), viewports_(viewports), series_(series), load_(load), wake_(std::move(wake)) {}

Follower::~Follower() { stop_ = true; }

void Follower::follow(const std::string& path, bool on) {
  if (path.empty() || on == follows(path)) return;
  File& file = files_[path];
  file.on = on;
  file.newest = true;
  file.version.clear();
  file.wait = least_wait(path);
  file.due = step_.now;
  if (on) reload(path, file);  // the file may have changed since it was read
  step_.frame.news = true;
}

bool Follower::follows(const std::string& path) const {
  if (step_.simulated) return false;
  const auto found = files_.find(path);
  return found == files_.end() ? load_.follow || is_live(path) : found->second.on;
}

bool Follower::is_live(const std::string& path) const {
  const auto document = viewports_.panes().documents().document(path);
  return document && !document->world.live.empty();
}

double Follower::least_wait(const std::string& path) const {
  if (is_live(path)) return kLeastWaitForLive;
  return is_on_server(path) ? kLeastWaitForServers : kLeastWait;
}

double Follower::most_wait(const std::string& path) const {
  return is_live(path) ? kMostWaitForLive : is_on_server(path) ? kMostWaitForServers : kMostWait;
}

void Follower::follow_newest(const std::string& path, bool on) {
  if (!follows(path)) return;
  const auto [found, added] = files_.try_emplace(path);
  if (found->second.newest != on || added) step_.frame.news = true;
  found->second.newest = on;
  if (on) viewports_.panes().documents().reload_unedited(path);
}

bool Follower::shows_newest(const std::string& path) const {
  const auto found = files_.find(path);
  return follows(path) && (found == files_.end() || found->second.newest);
}

std::vector<std::string> Follower::visible() const {
  std::vector<std::string> paths;
  const Panes& panes = viewports_.panes();
  const auto add = [&](const std::string& path) {
    if (!path.empty() && follows(path) && std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
  };
  for (const std::size_t i : panes.visible()) {
    add(panes.at(i).wanted);
    if (const View* const view = panes.at(i).view())
      for (const View::Over& over : view->over) add(over.path);
  }
  return paths;
}

void Follower::check() {
  for (const std::string& path : visible()) {
    auto [found, added] = files_.try_emplace(path);
    File& file = found->second;
    if (added) {
      file.due = step_.now;
      file.wait = least_wait(path);
    }
    if (file.coming.valid() && file.coming.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
      const std::string version = file.coming.get();
      // A simulation may have written a step between the reading of its world and the first check, and then waits for
      // this viewer.
      const bool known = !file.version.empty() || is_live(path);
      const bool changed = !version.empty() && known && version != file.version;
      constexpr double kLonger = 1.5;
      if (!version.empty()) file.version = version;
      file.changed = file.changed || changed;
      if (changed) file.pause = kLeastWait;
      file.wait = changed ? least_wait(path) : std::min(file.wait * kLonger, most_wait(path));
      file.due = step_.now + file.wait;
    }
    if (file.changed && step_.now >= file.again && !viewports_.panes().documents().awaited(path)) {
      file.changed = false;
      reload(path, file);
    }
    if (file.coming.valid() || step_.now < file.due) continue;
    file.coming = std::async(std::launch::async, [path = file_of_view(path), &load = load_, this] {
      std::string version = version_of(path, load, stop_);
      wake_();
      return version;
    });
  }
}

void Follower::reload(const std::string& path, File& file) {
  const std::string name = file_of_view(path);
  if (series_.find(name) && series_.refresh(name, file.newest)) step_.frame.news = true;
  viewports_.panes().documents().add(path);
}

std::optional<double> Follower::next_due() const {
  std::optional<double> next;
  for (const std::string& path : visible()) {
    const auto found = files_.find(path);
    if (found == files_.end()) return step_.now;
    const File& file = found->second;
    const bool reads = viewports_.panes().documents().awaited(path);  // its reader wakes the session
    double due = file.changed && !reads ? std::min(file.again, file.due) : file.due;
    // The thread wakes the session just before its result is there.
    constexpr double kSoon = 0.05;
    if (file.coming.valid()) due = step_.now + kSoon;
    next = std::min(next.value_or(due), due);
  }
  return next;
}

bool Follower::note_failed(const std::string& path) {
  if (!follows(path)) return false;
  constexpr double kLonger = 1.5;
  File& file = files_[path];
  file.changed = true;
  file.again = step_.now + file.pause;
  file.pause = std::min(file.pause * kLonger, kMostWait);
  return true;
}

}  // namespace gs::app
