#include "qnv/codecs/gaussians/encode/parted_encoder.h"

#include "qnv/codecs/gaussians/encode/part_tree.h"
#include "qnv/codecs/gaussians/encode/splat_parts.h"
#include "qnv/codecs/gaussians/encode/stream_plan.h"
#include "qnv/codecs/gaussians/encode/tree_cuts.h"
#include "qnv/codecs/gaussians/encode/visibility.h"
#include "qnv/codecs/shared/shared_records.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

// Number of sampled splats that determine the cells and the plan.
constexpr std::size_t kSampled = std::size_t{1} << 18;
// Size of cells in the sample, as a share of the maximum part. The margin allows for the error of the sample.
constexpr double kUsualShare = 0.85;
// Roots that a part passes to the common tree, and nodes below these roots at which the common tree ends. Because there
// are more such nodes than roots, clusters at the border have Gaussians of few parts.
constexpr std::size_t kRoots = 256, kTop = 1024;
// Memory for parts that are encoded at the same time, unless the options set it.
constexpr std::size_t kUsualMemory = std::size_t{400} << 20;
// Peak bytes of memory per splat of a part without harmonics, and per coefficient of harmonics.
constexpr std::size_t kSplatBytes = 620, kHarmonicBytes = 16;

/// Part of the scene with the results of each stage.
struct Part {
  StoredPart splats;
  StoredTree tree;
  PartTop top;
  std::vector<OpenRange> ranges;
  std::unique_ptr<ChunkRecords> records;
};

/// Splat of the sample.
struct SampledSplat {
  glm::vec3 position{0}, scales{0};
  float opacity = 0;
};

/// Encoder of one scene. Each rank reads some runs of the source, and encodes some parts. All ranks encode the common
/// tree, because each rank would otherwise wait for the result of one rank.
class PartedEncoder {
 public:
  PartedEncoder(const GaussianSource& source, std::size_t most, const EncodeOptions& options, Progress* progress)
      : source_(source),
        most_(std::max<std::size_t>(most, 1)),
        options_(options),
        progress_(progress),
        shared_(options),
        runs_(share_of(shared_.ranks(), std::max<std::size_t>(source.runs.size(), 1))),
        store_(shared_.store()) {}

  std::variant<EncodedStream, EncodeError> run() {
    begin_stage("reading", 2 * source_.count / shared_.count());
    if (!survey() || !divide()) return problem();
    begin_stage("encoding", 2 * source_.count / shared_.count());
    if (!agreed(for_parts([this](std::size_t i) { return build_tree(i); })) || !agreed(share_tops())) return problem();
    for (Part& part : parts_) top_.add(std::exchange(part.top, {}));
    if (!agreed(encode_top())) return problem();
    if (!agreed(for_parts([this](std::size_t i) { return encode_part(i); }))) return problem();
    share_records();
    std::vector<ChunkRecord> records;
    std::vector<std::uint32_t> clusters;
    top_records_.append_to(records, clusters);
    for (Part& part : parts_) {
      part.records->append_to(records, clusters);
      part.records = nullptr;
    }
    begin_stage("writing", 0);
    return write_chunks(std::move(plan_.header), std::move(records), store_, options_);
  }

 private:
  /// Keeps the first problem. Returns false.
  bool fail(EncodeError problem) {
    const std::scoped_lock lock(mutex_);
    if (!problem_) problem_ = std::move(problem);
    return false;
  }
  bool fail_to_store() { return fail({store_.problem()}); }
  [[nodiscard]] EncodeError problem() {
    if (is_cancelled(progress_)) return {"cancelled"};
    const std::scoped_lock lock(mutex_);
    return problem_.value_or(EncodeError{"cannot read the splats"});
  }

  /// Returns true if no rank failed. Otherwise keeps the problem of the first rank with one. Collective.
  bool agreed(bool good) {
    const auto failed = shared_.agree(good ? std::nullopt : std::optional(problem()));
    if (!failed) return true;
    const std::scoped_lock lock(mutex_);
    problem_ = *failed;
    return false;
  }

  void begin_stage(const char* stage, std::uint64_t total) {
    if (!progress_) return;
    progress_->stage = stage;
    progress_->done = 0;
    progress_->total = total;
  }
  void advance(std::uint64_t splats) {
    if (progress_) progress_->done += splats;
  }

  /// Reads the splats of this rank's runs.
  bool read_share(const std::function<bool(const Gaussians&)>& take) const {
    if (source_.runs.empty()) return runs_.size() == 0 || source_.read(take);
    for (std::uint64_t run = runs_.first; run < runs_.end; ++run)
      if (!source_.read_run(run, take)) return false;
    return true;
  }

  /// Reads and checks all splats; finds their box, a sample and the plan. Collective.
  bool survey() {
    const std::uint64_t every = std::max<std::uint64_t>(1, source_.count / kSampled);
    std::vector<SampledSplat> own;
    Box own_box;
    std::uint64_t read = 0;
    for (std::size_t run = 0; run < std::min<std::size_t>(runs_.first, source_.runs.size()); ++run)
      read += source_.runs[run];
    const bool good = read_share([&](const Gaussians& splats) {
      if (is_cancelled(progress_)) return false;
      if (auto found = problem_of(splats, read)) return fail(std::move(*found));
      for (std::size_t i = 0; i < splats.size(); ++i, ++read) {
        own_box.add(splats.positions[i]);
        if (read % every == 0) own.push_back({splats.positions[i], splats.scales[i], splats.opacities[i]});
      }
      advance(splats.size());
      return true;
    });
    if (!agreed(good)) return false;
    Box box;
    for (const Box& one : gather_records<Box>(shared_.ranks(), std::span(&own_box, 1))) box.add(one);
    Gaussians sample;
    for (const SampledSplat& one : gather_records<SampledSplat>(shared_.ranks(), own)) {
      sample.positions.push_back(one.position);
      sample.scales.push_back(one.scales);
      sample.opacities.push_back(one.opacity);
    }
    own = {};
    if (sample.empty()) return fail({"the source has no Gaussians; expected at least one"});
    plan_ = plan_of(source_, sample, box, options_);
    const double share = kUsualShare * static_cast<double>(most_) / static_cast<double>(every);
    cells_ = std::make_unique<SpaceCells>(std::move(sample.positions), static_cast<std::size_t>(share));
    return true;
  }

  /// Reads all splats, and stores them by parts. Collective.
  bool divide() {
    PartWriter writer(*cells_, source_.degree, store_);
    bool good = read_share([&](const Gaussians& splats) {
      if (is_cancelled(progress_)) return false;
      if (!writer.add(splats)) return fail_to_store();
      advance(splats.size());
      return true;
    });
    const auto blocks = good ? writer.finish() : std::nullopt;
    if (good && (!blocks || !shared_.store().publish())) good = fail_to_store();
    if (!agreed(good)) return false;
    std::vector<StoredPart> stored =
        parts_of(gather_records<CellBlock>(shared_.ranks(), *blocks), source_.degree, most_);
    parts_.resize(stored.size());
    for (std::size_t i = 0; i < stored.size(); ++i) parts_[i].splats = std::move(stored[i]);
    own_ = share_of(shared_.ranks(), parts_.size());
    return true;
  }

  /// Passes the tops of all parts to all ranks, through the store. Collective.
  bool share_tops() {
    if (shared_.count() == 1) return true;
    std::vector<std::byte> own, all;
    for (std::uint64_t i = own_.first; i < own_.end; ++i) append_top(own, parts_[i].top);
    const auto failed = collect_bytes(shared_, own, true, [&](std::uint64_t bytes) {
      all.resize(static_cast<std::size_t>(bytes));
      return std::span(all);
    });
    if (failed) return fail(*failed);
    std::span<const std::byte> rest = all;
    for (Part& part : parts_) {
      auto top = next_top(rest);
      if (!top) return fail({"cannot pass data between processes"});
      part.top = std::move(*top);
    }
    return true;
  }

  /// Passes the records of all parts to all ranks. Collective.
  void share_records() {
    if (shared_.count() == 1) return;
    std::vector<std::uint32_t> counts, clusters;
    std::vector<ChunkRecord> records;
    for (std::uint64_t i = own_.first; i < own_.end; ++i) {
      const ChunkRecords& own = *parts_[i].records;
      counts.push_back(static_cast<std::uint32_t>(own.records().size()));
      counts.push_back(static_cast<std::uint32_t>(own.clusters().size()));
      records.insert(records.end(), own.records().begin(), own.records().end());
      clusters.insert(clusters.end(), own.clusters().begin(), own.clusters().end());
    }
    counts = gather_records<std::uint32_t>(shared_.ranks(), counts);
    records = gather_records<ChunkRecord>(shared_.ranks(), records);
    clusters = gather_records<std::uint32_t>(shared_.ranks(), clusters);
    std::span<const ChunkRecord> next = records;
    std::span<const std::uint32_t> next_cluster = clusters;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const std::size_t of_part = counts[2 * i], clusters_of_part = counts[2 * i + 1];
      parts_[i].records =
          std::make_unique<ChunkRecords>(store_, first_id_, next.first(of_part), next_cluster.first(clusters_of_part));
      next = next.subspan(of_part);
      next_cluster = next_cluster.subspan(clusters_of_part);
    }
  }

  /// Calls work(i) for this rank's parts, several at a time if memory permits. Stops and returns false if a call fails.
  template <class Work>
  bool for_parts(const Work& work) {
    const std::size_t each = most_ * (kSplatBytes + kHarmonicBytes * harmonic_count(source_.degree));
    const std::size_t fit = std::max<std::size_t>(1, (options_.memory ? options_.memory : kUsualMemory) / each);
    const unsigned cores = options_.threads ? options_.threads : std::max(1u, std::thread::hardware_concurrency());
    const auto threads = static_cast<unsigned>(std::min<std::size_t>(cores, fit));
    std::atomic<bool> good{true};
    const bool done = parallel_for(
        static_cast<std::size_t>(own_.size()),
        [&](std::size_t i) {
          if (good && !work(static_cast<std::size_t>(own_.first) + i)) good = false;
        },
        threads, progress_);
    return done && good;
  }

  /// Returns the name of work on a part. It identifies the result for later runs. Parts do not depend on ranks.
  [[nodiscard]] std::string name_of(const char* work, std::size_t i) const {
    return std::string(work) + " " + std::to_string(most_) + " " + std::to_string(parts_.size()) + " " +
           std::to_string(i);
  }

  bool build_tree(std::size_t i) {
    Part& part = parts_[i];
    if (restore_tree(name_of("tree", i), part.splats.splats, store_, part.tree, part.top)) {
      advance(part.splats.splats);
      return true;
    }
    const auto splats = read_part(part.splats, source_.degree, store_);
    if (!splats) return fail_to_store();
    // Ignores other parts. They rarely hide a splat that is visible within its own part.
    const std::vector<float> visibility = visibility_of(*splats, 1, progress_);
    if (visibility.empty()) return false;
    Forest leaves = leaves_of(*splats, splats->description.box, plan_.detail, visibility);
    const auto tree = MergeTree::join(std::move(leaves), plan_.detail, kRoots, 1, progress_);
    if (!tree) return false;
    part.top = top_of(*tree, *splats, kTop);
    auto stored = store_tree(*tree, part.top, name_of("tree", i), part.splats.splats, store_);
    if (!stored) return fail_to_store();
    part.tree = std::move(*stored);
    advance(part.splats.splats);
    return true;
  }

  /// Joins the tops of the parts and encodes the clusters of the common tree. Passes their ends to the parts.
  bool encode_top() {
    const auto tree = MergeTree::join(std::move(top_.forest), plan_.detail, 1, options_.threads, progress_);
    if (!tree) return false;
    const auto fitted = options_.fitted ? fit_nodes(*tree, fit_start(), options_.threads, progress_) : FittedNodes();
    if (!fitted) return false;
    ClusterWork work{top_.leaves, *tree, plan_.precision};
    work.fitted = &*fitted;
    const MeanHarmonics harmonics(*tree, top_.leaves, std::move(top_.harmonics));
    std::vector<OpenCluster> given;
    if (!encode_chunks(work, {}, harmonics, options_, top_records_, &given, progress_)) return fail_to_store();
    first_error_ = work.first_error;
    first_id_ = top_records_.end_id();
    for (const OpenCluster& cluster : given) add_ranges(cluster);
    return true;
  }

  /// Divides a cluster at the end of the common tree into ranges. Each range has Gaussians of one part.
  void add_ranges(const OpenCluster& cluster) {
    const std::size_t count = cluster.nodes.size();
    const auto part_at = [&](std::size_t i) { return top_.origins[cluster.places[i]].part; };
    for (std::size_t from = 0; from < count;) {
      while (from < count && cluster.nodes[from].leaf) ++from;
      if (from == count) return;
      std::size_t to = from + 1;
      while (to < count && (cluster.nodes[to].leaf || part_at(to) == part_at(from))) ++to;
      OpenRange range{cluster, from, to};
      for (std::size_t i = from; i < to; ++i) range.cluster.places[i] = top_.origins[cluster.places[i]].place;
      parts_[part_at(from)].ranges.push_back(std::move(range));
      from = to;
    }
  }

  bool encode_part(std::size_t i) {
    Part& part = parts_[i];
    part.records = ChunkRecords::finished(name_of("chunks", i), first_id_, store_);
    if (!part.records) {
      // Collects the chunks, so that they are consecutive in the store.
      MemoryStore memory;
      SharedStore collected(memory);
      ChunkRecords records(collected, first_id_);
      if (!part.ranges.empty() && !encode_ranges(part, records)) return false;
      part.records = records.finish(name_of("chunks", i), memory, store_);
      if (!part.records) return fail_to_store();
    }
    advance(part.splats.splats);
    return true;
  }

  [[nodiscard]] FitStart fit_start() const { return {{}, source_.antialiased, options_.vectors}; }

  bool encode_ranges(Part& part, ChunkRecords& records) {
    const auto splats = read_part(part.splats, source_.degree, store_);
    const auto tree = splats ? read_tree(part.tree, *splats, plan_.detail, store_) : std::nullopt;
    if (!tree) return fail_to_store();
    const MeanHarmonics harmonics(*tree, *splats);
    FitStart start = fit_start();
    for (const OpenRange& range : part.ranges)
      for (std::size_t i = range.from; i < range.to; ++i)
        if (!range.cluster.nodes[i].leaf)
          start.nodes.emplace_back(range.cluster.places[i], error_below(first_error_, range.cluster.head.level));
    const auto fitted = options_.fitted ? fit_nodes(*tree, start, 1, progress_) : FittedNodes();
    if (!fitted) return false;
    ClusterWork work{*splats, *tree, plan_.precision, first_id_, first_error_, &*fitted};
    return encode_chunks(work, std::exchange(part.ranges, {}), harmonics, options_, records, nullptr, progress_) ||
           fail_to_store();
  }

  const GaussianSource& source_;
  std::size_t most_;
  const EncodeOptions& options_;
  Progress* progress_;
  EncodeRanks shared_;
  RankShare runs_, own_;  // this rank's runs of the source, and its parts
  SharedStore store_;
  StreamPlan plan_;
  std::unique_ptr<SpaceCells> cells_;
  std::vector<Part> parts_;
  TopForest top_;
  ChunkRecords top_records_{store_, 0};
  float first_error_ = 0;
  std::uint32_t first_id_ = 0;  // first identifier of clusters of parts
  std::mutex mutex_;
  std::optional<EncodeError> problem_;
};

}  // namespace

std::variant<EncodedStream, EncodeError> encode_in_parts(const GaussianSource& source, std::size_t most,
                                                         const EncodeOptions& options, Progress* progress) {
  return PartedEncoder(source, most, options, progress).run();
}

}  // namespace gs::qnv::gaussians
