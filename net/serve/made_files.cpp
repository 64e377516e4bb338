#include "net/serve/made_files.h"

#include "net/base/siphash.h"
#include "net/files/temporary_folder.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>
#include <span>
#include <utility>
#include <variant>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMaxFailures = 256;
constexpr const char* kWorkFolders = "making";  // name prefix of the folders for unfinished files

std::string made_name_of(const std::string& key) {
  const auto bytes = std::as_bytes(std::span(key));
  char text[40];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(siphash(SipKey{}, bytes)),
                static_cast<unsigned long long>(siphash(SipKey{1, 0}, bytes)));
  return text;
}

// Reports whether a name has the form of a made file. Other files in the folder must not be deleted.
bool is_ours(const std::string& name) {
  return name.size() > 33 && name[32] == '.' && name.find_first_not_of("0123456789abcdef") == 32;
}

}  // namespace

MadeFiles::MadeFiles(Options options, const std::vector<std::size_t>& at_once, std::function<void()> wake)
    : options_(std::move(options)), wake_(std::move(wake)), lanes_(at_once.size()) {
  (void)remove_abandoned_folders(options_.folder, kWorkFolders);
  for (std::size_t number = 0; number < at_once.size(); ++number)
    for (std::size_t i = 0; i < at_once[number]; ++i)
      lanes_[number].threads.emplace_back(
          [this, &lane = lanes_[number]](const std::stop_token& stop) { work(lane, stop); });
}

MadeFiles::~MadeFiles() {
  for (Lane& lane : lanes_)
    for (std::jthread& thread : lane.threads) thread.request_stop();
  for (Lane& lane : lanes_)
    for (std::jthread& thread : lane.threads) thread.join();
}

MadeFile MadeFiles::request(std::size_t lane_number, const std::string& key, const std::string& extension, Make make) {
  const std::string name = made_name_of(key), path = options_.folder + "/" + name + extension;
  const std::lock_guard lock(mutex_);
  Lane& lane = lanes_[lane_number];
  for (const Job& job : lane.jobs)
    if (job.key == key) return {};
  // Update the access time, so that other files are removed first.
  const timespec times[2] = {{0, UTIME_NOW}, {0, UTIME_OMIT}};
  if (::utimensat(AT_FDCWD, path.c_str(), times, AT_SYMLINK_NOFOLLOW) == 0) return {MadeState::ready, path, {}};
  std::erase_if(lane.failures, [now = options_.now()](const Failed& failed) { return now >= failed.until; });
  for (const Failed& failed : lane.failures)
    if (failed.key == key) return {MadeState::failed, {}, failed.failure};
  if (lane.jobs.size() >= options_.most_waiting) return {MadeState::full, {}, {}};
  lane.jobs.push_back({key, name, extension, std::move(make), std::nullopt});
  arrived_.notify_all();
  return {};
}

bool MadeFiles::is_waiting(std::size_t lane, const std::string& key) const {
  const std::lock_guard lock(mutex_);
  const auto& jobs = lanes_[lane].jobs;
  return std::any_of(jobs.begin(), jobs.end(), [&](const Job& job) { return job.key == key; });
}

MadeFiles::Statistics MadeFiles::statistics(std::size_t lane) const {
  const std::lock_guard lock(mutex_);
  Statistics result = lanes_[lane].statistics;
  result.waiting = lanes_[lane].jobs.size();
  return result;
}

std::list<MadeFiles::Job>::iterator MadeFiles::begin_next(Lane& lane, std::unique_lock<std::mutex>& lock,
                                                          const std::stop_token& stop) {
  const auto first_waiting = [&lane] {
    return std::find_if(lane.jobs.begin(), lane.jobs.end(), [](const Job& job) { return !job.begun; });
  };
  // Returns the time at which the newest running job becomes slow.
  const auto quick_until = [&] {
    Instant until{};
    for (const Job& job : lane.jobs)
      if (job.begun) until = std::max(until, *job.begun + options_.patience);
    return until;
  };
  while (!stop.stop_requested()) {
    const auto next = first_waiting();
    const Instant now = clock_now(), until = quick_until();
    if (next == lane.jobs.end()) {
      (void)arrived_.wait(lock, stop, [&] { return first_waiting() != lane.jobs.end(); });
    } else if (now < until) {
      (void)arrived_.wait_for(lock, stop, until - now, [&] { return quick_until() < until; });
    } else {
      next->begun = now;
      return next;
    }
  }
  return lane.jobs.end();
}

void MadeFiles::work(Lane& lane, const std::stop_token& stop) {
  for (;;) {
    std::list<Job>::iterator job;
    {
      std::unique_lock lock(mutex_);
      job = begin_next(lane, lock, stop);
      if (job == lane.jobs.end()) return;
    }
    // Other threads do not touch a job that has begun.
    const auto failure = make(*job, stop);
    {
      const std::lock_guard lock(mutex_);
      ++(failure ? lane.statistics.failed : lane.statistics.made);
      // A stopped job does not count as failed.
      if (failure && !stop.stop_requested())
        lane.failures.push_back(
            {job->key, *failure,
             options_.now() + (failure->lasting ? options_.lasting_failure : options_.passing_failure)});
      if (lane.failures.size() > kMaxFailures) lane.failures.pop_front();
      lane.jobs.erase(job);
      arrived_.notify_all();
    }
    if (!failure) clean();
    wake_();
  }
}

std::optional<MakeFailure> MadeFiles::make(const Job& job, const std::stop_token& stop) {
  // The folder may be missing, because a user may delete the cache while the server runs.
  std::error_code error;
  if (fs::create_directories(options_.folder, error)) fs::permissions(options_.folder, fs::perms::owner_all, error);
  auto folder = LockedFolder::make(options_.folder, kWorkFolders);
  if (auto* problem = std::get_if<std::string>(&folder)) return MakeFailure{std::move(*problem), false};
  const std::string out = std::get<LockedFolder>(folder).path() + "/made" + job.extension;
  try {
    if (auto failure = job.make(out, stop)) return failure;
  } catch (const std::bad_alloc&) {
    return MakeFailure{"not enough memory", false};
  }
  if (::rename(out.c_str(), (options_.folder + "/" + job.name + job.extension).c_str()) != 0)
    return MakeFailure{"the generated file cannot be stored", false};
  return std::nullopt;
}

void MadeFiles::clean() {
  struct Kept {
    std::string path;
    std::uint64_t size;
    timespec used;
  };
  const std::lock_guard lock(cleaning_);
  std::vector<Kept> all;
  std::uint64_t total = 0;
  std::error_code error;
  for (fs::directory_iterator file(options_.folder, error), end; !error && file != end; file.increment(error)) {
    const std::string name = file->path().filename().string(), path = file->path().string();
    struct stat status {};
    if (!is_ours(name) || ::lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    all.push_back({path, static_cast<std::uint64_t>(status.st_size), status.st_atim});
    total += all.back().size;
  }
  std::sort(all.begin(), all.end(), [](const Kept& a, const Kept& b) {
    return std::pair(a.used.tv_sec, a.used.tv_nsec) < std::pair(b.used.tv_sec, b.used.tv_nsec);
  });
  // Keep the newest file even if it alone exceeds the limit: a client waits for it.
  for (std::size_t i = 0; i + 1 < all.size() && total > options_.most_bytes; ++i) {
    (void)::unlink(all[i].path.c_str());
    total -= all[i].size;
  }
}

}  // namespace gs::net
