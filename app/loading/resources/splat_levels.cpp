#include "app/loading/resources/splat_levels.h"

#include "app/formats/confined/confined_import.h"
#include "app/formats/qnv/geometry_reader.h"
#include "app/formats/splats/splat_join.h"
#include "app/formats/splats/splats.h"
#include "app/formats/splats/splats_sog.h"
#include "app/loading/fetch/fetch.h"
#include "app/loading/fetch/read_resources.h"
#include "app/streams/load_ledger.h"
#include "app/streams/view_notes.h"
#include "net/limits/clock.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <span>
#include <string_view>
#include <variant>

namespace gs::app {
namespace {

constexpr std::size_t kMostJobs = 3;         // concurrent transfers of SOGs
constexpr std::size_t kMostUnreadable = 16;  // failures after which no more files are read
constexpr std::uint64_t kMostSogFile = std::uint64_t{256} << 20;
constexpr std::uint64_t kMostKeptFiles = std::uint64_t{64} << 20;  // bytes of received files for later runs
constexpr std::uint32_t kBetweenRatio = 4;  // an intermediate level has at most 1 / 4 of the next one's splats
constexpr int kSplatPriority = 1500;        // equal to that of chunks of streams

std::uint64_t bytes_of_splats(const qnv::Gaussians& splats) {
  return splats.size() * (kSplatMemory / 2 + sizeof(glm::vec3) * qnv::harmonic_count(splats.degree));
}

/// Parses the numbers of kSogPartCounts.
std::vector<std::size_t> part_counts(const qnv::Gaussians& splats) {
  std::vector<std::size_t> counts;
  for (const auto& [key, value] : splats.description.metadata) {
    if (key != kSogPartCounts) continue;
    const char* next = value.data();
    const char* const end = next + value.size();
    while (next < end) {
      std::size_t count = 0;
      const auto [after, error] = std::from_chars(next, end, count);
      if (error != std::errc()) return {};
      counts.push_back(count);
      next = after < end ? after + 1 : after;
    }
  }
  return counts;
}

}  // namespace

SplatLevels::SplatLevels(Loading& loading, Source source)
    : loading_(loading),
      source_(std::move(source)),
      most_(loading.budget->left(Resource::vectors) / kSogSplatBytes),
      feed_(std::make_shared<StreamFeed>(std::make_shared<ViewNotes>(), [waker = loading.waker] { waker->wake(); })),
      unreadable_(source_.levels.files.size() + 1) {}

SplatLevels::~SplatLevels() { feed_->finish(); }

const std::string& SplatLevels::path_of(std::uint32_t file) const {
  return file < source_.levels.files.size() ? source_.levels.files[file] : *source_.levels.environment;
}

// The environment has one run of unknown length.
SogRun SplatLevels::run_of(const Key& key) const {
  if (key.first < source_.levels.leaves.size()) return source_.levels.leaves[key.first].runs[key.second];
  return {0, static_cast<std::uint32_t>(source_.levels.files.size()), 0, 0};
}

std::uint64_t SplatLevels::held_splats() const {
  std::uint64_t splats = 0;
  for (const auto& [key, piece] : pieces_) splats += piece.splats.size();
  return splats;
}

std::shared_ptr<const qnv::Geometry> SplatLevels::read_first() {
  while (!over_) {
    choose();
    if (wanted_.empty()) break;
    read_now(wanted_.front().file);
    if (!changed_) continue;
    if (auto geometry = compose()) return geometry;
    break;
  }
  if (!over_ && failures_ > 0)
    loading_.results.report(Severity::error, source_.path, {}, "no file of its levels can be read");
  over_ = true;
  return nullptr;
}

// Makes the list of wanted files: those of the coarsest runs first, then those that views need.
void SplatLevels::choose() {
  chosen_ = true;
  const SogLevels& levels = source_.levels;
  base_ = coarsest_sog_runs(levels, unreadable_);
  // While the user moves, views accept larger errors. Files are requested as for a view at rest.
  std::vector<qnv::LodView> views = views_;
  for (qnv::LodView& view : views) view.error_pixels = std::min(view.error_pixels, 1.0f);
  SogRefinement refined = sog_runs_in_view(levels, unreadable_, views, origin_, most_);
  target_ = std::move(refined.choice);
  drop_unwanted();
  wanted_.clear();
  at_.assign(unreadable_.size(), std::nullopt);
  for (std::uint32_t leaf = 0; leaf < base_.size(); ++leaf) {
    const auto held = pieces_.lower_bound({leaf, 0});
    const bool has_any = held != pieces_.end() && held->first.first == leaf;
    if (base_[leaf] != kNoSogRun && !has_any) add_wanted(leaf, base_[leaf]);
  }
  const auto splats_of = [&](const Wanted& wanted) {
    std::uint64_t splats = 0;
    for (const Key& key : wanted.keys) splats += run_of(key).count;
    return splats;
  };
  std::ranges::stable_sort(wanted_, std::ranges::greater{}, splats_of);
  for (std::size_t i = 0; i < wanted_.size(); ++i) at_[wanted_[i].file] = i;
  for (const SogStep& step : refined.steps)
    if (step.run == target_[step.leaf] || is_between(step)) add_wanted(step.leaf, step.run);
  // Requests the missing coarsest runs last, so that parts that leave the view need no further file.
  for (std::uint32_t leaf = 0; leaf < base_.size(); ++leaf)
    if (base_[leaf] != kNoSogRun) add_wanted(leaf, base_[leaf]);
  if (levels.environment && !unreadable_.back()) add_wanted(static_cast<std::uint32_t>(levels.leaves.size()), 0);
  for (std::size_t i = jobs_.size(); i-- > 0;)
    if (std::ranges::none_of(wanted_, [&](const Wanted& one) { return one.file == jobs_[i].file; })) end_job(i, false);
}

// Returns true for an intermediate level that is much smaller than the wanted one, and is therefore shown first.
bool SplatLevels::is_between(const SogStep& step) const {
  if (!source_.shows_between) return false;
  const SogLeaf& leaf = source_.levels.leaves[step.leaf];
  const auto held = pieces_.lower_bound({step.leaf, 0});
  if (held != pieces_.end() && held->first.first == step.leaf && held->first.second <= step.run) return false;
  std::uint32_t last = leaf.runs[target_[step.leaf]].count;
  for (std::size_t run = std::size_t{target_[step.leaf]} + 1; run < leaf.runs.size(); ++run) {
    if (unreadable_[leaf.runs[run].file] || leaf.runs[run].count > last / kBetweenRatio) continue;
    last = leaf.runs[run].count;
    if (run == step.run) return true;
  }
  return false;
}

void SplatLevels::add_wanted(std::uint32_t leaf, std::uint8_t run) {
  const Key key{leaf, run};
  if (pieces_.contains(key)) return;
  const std::uint32_t file = run_of(key).file;
  if (!at_[file]) {
    at_[file] = wanted_.size();
    wanted_.push_back({file, {}});
  }
  wanted_[*at_[file]].keys.insert(key);
}

// Drops runs that are neither coarsest nor wanted, if there are too many.
void SplatLevels::drop_unwanted() {
  if (held_splats() <= most_) return;
  changed_ = std::erase_if(pieces_,
                           [&](const auto& one) {
                             const auto& [leaf, run] = one.first;
                             return leaf < base_.size() && run != base_[leaf] && run != target_[leaf];
                           }) > 0 ||
             changed_;
}

bool SplatLevels::ask_for_more() {
  if (over_) return false;
  if (feed_->take_views(views_) || !chosen_) choose();
  bool any = false;
  if (!wanted_.empty()) {
    const auto kept = std::ranges::find_if(wanted_, [&](const Wanted& one) { return files_.contains(one.file); });
    if (kept != wanted_.end() || source_.local) {
      read_now(kept != wanted_.end() ? kept->file : wanted_.front().file);
      any = true;
    } else {
      any = start_jobs();
    }
  }
  show_if_due();
  return any;
}

bool SplatLevels::start_jobs() {
  bool any = false;
  for (std::size_t i = 0; i < wanted_.size() && jobs_.size() < kMostJobs && !over_; ++i) {
    const std::uint32_t file = wanted_[i].file;
    if (std::ranges::find(jobs_, file, &Job::file) != jobs_.end()) continue;
    Job job;
    job.file = file;
    job.share = Share(loading_.budget, Resource::files);
    job.priority = kSplatPriority - static_cast<int>(std::min<std::size_t>(i, 400));
    const net::Url url = net::resolve(net::parse_url(source_.origin.url), net::parse_url(path_of(file)));
    job.row = loading_.ledger->begin(net::url_for_messages(url.text()), url.scheme, nullptr);
    jobs_.push_back(std::move(job));
    any = true;
    request(jobs_.back(), path_of(file));
    if (!jobs_.back().files.empty()) continue;
    end_job(jobs_.size() - 1, false);
    const auto refused = loading_.fetcher.policy().refuse(source_.origin, url);
    fail(file, path_of(file) + ": " + (refused ? refused->message : std::string(kOfflineProblem)));
    --i;
  }
  return any;
}

// Requests a file of a job. Adds nothing if the policy refuses it.
void SplatLevels::request(Job& job, const std::string& path) {
  const net::Url url = net::resolve(net::parse_url(source_.origin.url), net::parse_url(path));
  if (loading_.options.offline || loading_.fetcher.policy().refuse(source_.origin, url)) return;
  net::Request made;
  made.url = without_fragment(url);
  made.from = source_.origin;
  made.priority = job.priority;
  made.max_bytes = kMostSogFile;
  job.files.push_back({loading_.fetcher.network().loader().request(std::move(made)), path, {}, false});
}

bool SplatLevels::take(net::LoadEvent& event) {
  for (std::size_t i = 0; i < jobs_.size(); ++i) {
    Job& job = jobs_[i];
    const auto file = std::ranges::find(job.files, event.id, &Job::File::id);
    if (file == job.files.end()) continue;
    if (const auto* const data = std::get_if<net::LoadData>(&event.what)) {
      loading_.ledger->receive(job.row, data->bytes.size(), {});
      loading_.fetcher.count_received(data->bytes.size());
      if (job.share.grow(data->bytes.size())) {
        file->bytes.insert(file->bytes.end(), data->bytes.begin(), data->bytes.end());
        return true;
      }
      const std::uint32_t number = job.file;
      end_job(i, false);
      fail(number, path_of(number) + " needs " + loading_.budget->refusal(Resource::files));
    } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
      file->bytes.clear();
    } else if (std::holds_alternative<net::LoadDone>(event.what)) {
      file->done = true;
      if (job.files.size() == 1)
        for (const std::string& name : sog_files_of(file->bytes))
          request(job, path_of(job.file).substr(0, path_of(job.file).rfind('/') + 1) + name);
      if (std::ranges::all_of(job.files, &Job::File::done)) finish_job(i);
    } else if (const auto* const error = std::get_if<net::LoadError>(&event.what)) {
      const std::uint32_t number = job.file;
      const std::string why = error->message;
      end_job(i, false);
      fail(number, why);
    }
    return true;
  }
  return false;
}

void SplatLevels::finish_job(std::size_t index) {
  Files files;
  const std::uint32_t file = jobs_[index].file;
  for (Job::File& one : jobs_[index].files) files[one.path] = shared_bytes(std::move(one.bytes));
  end_job(index, true);
  const auto problem = decode(file, files);
  if (problem) return fail(file, *problem);
  keep_files(file, std::move(files));
}

void SplatLevels::end_job(std::size_t index, bool received) {
  Job& job = jobs_[index];
  for (const Job::File& file : job.files)
    if (!file.done) loading_.fetcher.network().loader().cancel(file.id);
  loading_.ledger->end(job.row, received ? LoadStage::whole : LoadStage::cancelled);
  jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(index));
}

// Reads a SOG that was received before, or waits for its files.
void SplatLevels::read_now(std::uint32_t file) {
  if (const auto kept = files_.find(file); kept != files_.end()) {
    kept->second.second = ++uses_;
    if (const auto problem = decode(file, kept->second.first)) fail(file, *problem);
    return;
  }
  const ReadFiles read = loading_.fetcher.files_of(source_.origin);
  const auto message = [](const std::string& name, const FileResult& result) -> std::string {
    if (const auto* const none = std::get_if<NoFile>(&result))
      return none->why.empty() ? name + " is missing" : none->why;
    return std::get<std::string>(result);
  };
  Files files;
  const std::string& path = path_of(file);
  const FileRequest meta{path};
  const FileResult head = read({&meta, 1}).front();
  if (!std::holds_alternative<SharedBytes>(head)) return fail(file, message(path, head));
  files[path] = std::get<SharedBytes>(head);
  std::vector<FileRequest> rest;
  for (const std::string& name : sog_files_of(files[path].bytes))
    rest.push_back({path.substr(0, path.rfind('/') + 1) + name});
  const std::vector<FileResult> results = read(rest);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (!std::holds_alternative<SharedBytes>(results[i])) return fail(file, message(rest[i].reference, results[i]));
    files[rest[i].reference] = std::get<SharedBytes>(results[i]);
  }
  if (const auto problem = decode(file, files)) return fail(file, *problem);
  if (!source_.local) keep_files(file, std::move(files));
}

std::optional<std::string> SplatLevels::decode(std::uint32_t file, const Files& files) {
  const auto wanted = std::ranges::find(wanted_, file, &Wanted::file);
  if (wanted == wanted_.end()) return std::nullopt;
  SogParts parts{path_of(file), {}};
  const bool is_environment = file == source_.levels.files.size();
  if (!is_environment)
    for (const Key& key : wanted->keys) parts.runs.push_back(run_of(key));
  const std::string text = text_of_sog_parts(parts);
  const ReadFile read = [&](const std::string& name) -> BytesResult {
    const auto found = files.find(name);
    return found == files.end() ? BytesResult(name + " is missing") : BytesResult(found->second);
  };
  Diagnostics problems;
  const ImportSource source{std::as_bytes(std::span(text)), source_.path, read, loading_.budget, problems};
  Asset asset = read_confined(*source_.type, source);
  auto* const splats = std::get_if<qnv::Gaussians>(&asset);
  const std::vector<Key> keys(wanted->keys.begin(), wanted->keys.end());
  const auto counts = splats ? part_counts(*splats) : std::vector<std::size_t>();
  std::size_t total = 0;
  for (const std::size_t count : counts)
    total += std::min(count, std::numeric_limits<std::uint32_t>::max() + std::size_t{1});
  if (!splats || counts.size() != keys.size() || total != splats->size())
    return problems.entries().empty() ? path_of(file) + " is damaged" : problems.entries().front().message;
  std::erase_if(splats->description.metadata, [](const auto& pair) { return pair.first == kSogPartCounts; });
  std::size_t first = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    Piece piece{range_of_splats(*splats, first, counts[i]), Share(loading_.budget, Resource::vectors)};
    first += counts[i];
    if (!piece.share.grow(bytes_of_splats(piece.splats)))
      return path_of(file) + " needs " + loading_.budget->refusal(Resource::vectors);
    if (!has_origin_ && !piece.splats.empty()) {
      origin_ = piece.splats.description.origin;
      has_origin_ = true;
    }
    pieces_[keys[i]] = std::move(piece);
  }
  std::erase_if(wanted_, [&](const Wanted& one) { return one.file == file; });
  changed_ = true;
  return std::nullopt;
}

// Caches the most recently used files, for other runs of these SOGs.
void SplatLevels::keep_files(std::uint32_t file, Files files) {
  files_[file] = {std::move(files), ++uses_};
  const auto bytes = [&] {
    std::uint64_t all = 0;
    for (const auto& [number, kept] : files_)
      for (const auto& [path, content] : kept.first) all += content.bytes.size();
    return all;
  };
  while (!files_.empty() && bytes() > kMostKeptFiles)
    files_.erase(std::ranges::min_element(files_, {}, [](const auto& one) { return one.second.second; }));
}

void SplatLevels::fail(std::uint32_t file, const std::string& why) {
  unreadable_[file] = true;
  std::erase_if(wanted_, [&](const Wanted& one) { return one.file == file; });
  files_.erase(file);
  chosen_ = false;
  const bool is_environment = file == source_.levels.files.size();
  loading_.results.report(Severity::warning, source_.path, {},
                          why + (is_environment ? "; the environment is left out" : "; another level replaces it"));
  if (++failures_ < kMostUnreadable) return;
  loading_.results.report(Severity::error, source_.path, {},
                          "too many files cannot be read; finer levels are left out");
  cancel();
}

void SplatLevels::cancel() {
  while (!jobs_.empty()) end_job(jobs_.size() - 1, false);
  wanted_.clear();
  over_ = true;
  feed_->finish();
}

void SplatLevels::cancel_row(std::uint64_t row) {
  const auto job = std::ranges::find(jobs_, row, &Job::row);
  if (job == jobs_.end()) return;
  const std::uint32_t file = job->file;
  end_job(static_cast<std::size_t>(job - jobs_.begin()), false);
  unreadable_[file] = true;
  chosen_ = false;
}

// Returns the run of each leaf to show: the wanted one, else the next coarser one in memory, else a finer one. Shows
// finer runs of previous views while memory suffices.
SogChoice SplatLevels::shown_choice() const {
  SogChoice shown(base_.size(), kNoSogRun);
  std::uint64_t total = 0;
  for (auto one = pieces_.begin(); one != pieces_.end();) {
    const std::uint32_t leaf = one->first.first;
    std::uint8_t coarser = kNoSogRun, finer = kNoSogRun;
    for (; one != pieces_.end() && one->first.first == leaf; ++one) {
      if (leaf >= base_.size()) continue;
      if (one->first.second < target_[leaf]) finer = one->first.second;
      if (one->first.second >= target_[leaf] && coarser == kNoSogRun) coarser = one->first.second;
    }
    if (leaf >= base_.size()) continue;
    shown[leaf] = coarser != kNoSogRun ? coarser : finer;
    total += run_of({leaf, shown[leaf]}).count;
  }
  for (std::uint32_t leaf = 0; leaf < shown.size(); ++leaf) {
    const auto finest = pieces_.lower_bound({leaf, 0});
    if (shown[leaf] == kNoSogRun || finest->first.second >= shown[leaf]) continue;
    const std::uint64_t larger = total - run_of({leaf, shown[leaf]}).count + run_of(finest->first).count;
    if (larger > most_) continue;
    total = larger;
    shown[leaf] = finest->first.second;
  }
  return shown;
}

std::shared_ptr<const qnv::Geometry> SplatLevels::compose() {
  changed_ = false;
  const SogChoice shown = shown_choice();
  std::vector<const qnv::Gaussians*> parts;
  for (std::uint32_t leaf = 0; leaf < shown.size(); ++leaf)
    if (shown[leaf] != kNoSogRun) parts.push_back(&pieces_.at({leaf, shown[leaf]}).splats);
  if (const auto environment = pieces_.find({static_cast<std::uint32_t>(base_.size()), 0});
      environment != pieces_.end())
    parts.push_back(&environment->second.splats);
  std::size_t count = 0;
  int degree = 0;
  for (const qnv::Gaussians* const part : parts) {
    count += part->size();
    degree = std::max(degree, part->degree);
  }
  if (count == 0) return nullptr;
  qnv::Gaussians all;
  reserve_splats(all, count, degree);
  for (const qnv::Gaussians* const part : parts) append_splats(all, *part);
  // Drops the counts of omitted splats, because each concerns one part only.
  std::erase_if(all.description.metadata,
                [](const auto& pair) { return pair.first != "source" && pair.first != kSplatsAsDiscs; });
  // Uses the box of all leaves, because cameras frame it and it must not change with the levels.
  for (const SogLeaf& leaf : source_.levels.leaves)
    if (!leaf.box.empty()) {
      all.description.box.add(glm::vec3(glm::dvec3(leaf.box.lower) - all.description.origin));
      all.description.box.add(glm::vec3(glm::dvec3(leaf.box.upper) - all.description.origin));
    }
  all.requests = feed_->requests();
  shown_splats_ = count;
  auto held = hold_geometry(std::move(all), loading_.budget);
  if (held) return held;
  loading_.results.report(Severity::error, source_.path, {},
                          loading_.budget->refusal(Resource::vectors) + "; finer levels are left out");
  cancel();
  return nullptr;
}

void SplatLevels::show_if_due() {
  if (!changed_ || !show_) return;
  const net::Instant began = net::clock_now();
  const bool last = wanted_.empty() && jobs_.empty();
  if (!last && !pace_.due(began)) return;
  if (auto geometry = compose()) {
    show_(std::move(geometry));
    loading_.fetcher.network().note_growth();
  }
  pace_.made(began, net::clock_now());
}

}  // namespace gs::app
