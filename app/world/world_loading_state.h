#pragma once

#include "app/base/gunzip.h"
#include "app/formats/content_types.h"
#include "app/world/arrivals.h"
#include "app/world/cell_stream.h"
#include "app/world/cloud_reader.h"
#include "app/world/outline_scene.h"
#include "app/world/ranged_stream.h"
#include "app/world/stream_feed.h"
#include "app/world/world_loading.h"
#include "net/base/file.h"
#include "net/base/url.h"
#include "net/load/loader.h"
#include "qnv/decode/decoder.h"
#include "vrml/syntax/parser.h"

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

// The inside of WorldLoading: world_loading.cpp, world_network.cpp and world_cells.cpp find the bytes, scene_taker.cpp
// and scene_references.cpp make scenes of them, cloud_taker.cpp vectors.

namespace gs::app {

/// Where the bytes of a resource were found.
struct Found {
  net::Url url;      // after redirects, without fragment
  std::string path;  // of a local file; of anything else the URL: what diagnostics call it
  std::string fragment;
  bool local = false;
  net::Origin origin;  // of what it holds, where that is a text
};

class Fetch;

/// Takes the bytes of one resource.
class Taker {
 public:
  Taker() = default;
  /// Whether it changes the nodes of scenes; while one does, the world cannot be given away.
  [[nodiscard]] virtual bool makes_nodes() const { return false; }
  Taker(const Taker&) = delete;
  Taker& operator=(const Taker&) = delete;
  virtual ~Taker() = default;
  /// The resource is there, and its bytes will come from the start. False: not wanted.
  virtual bool begin(const Found& found) = 0;
  /// A local file, to be read as a whole at once. False: it should rather come in pieces.
  virtual bool whole_file(const net::MappedFile&, const std::string&) { return false; }
  virtual void more(std::span<const std::byte> bytes) = 0;
  /// All is there (`problem` empty), or what is missing never comes.
  virtual void end(const std::optional<std::string>& problem) = 0;
  /// None of the places where it might be has it.
  virtual void missing(const std::string& why) = 0;
  /// Whether the rest, behind the front that has come, is better read here and there, as `place` says. True: it is
  /// seen to, and neither more bytes nor an end come.
  virtual bool seek(RangedStream::Place) { return false; }
  /// Of cells, behind the base: a chunk, or some of the records of one.
  virtual void piece(const net::CellEvent&) {}
  /// Whether what is there is enough, and views see to the rest by a feed. Null: no; else neither more nor an end come.
  virtual std::shared_ptr<StreamFeed> follow() { return nullptr; }

  bool cut = false;   // bytes are left out that nobody misses (`--max-bytes`)
  bool told = false;  // why it is missing has been said already
};

/// A resource, and where it may be.
class Fetch {
 public:
  std::vector<net::Url> candidates;  // with fragments
  std::size_t next = 0;
  net::Origin from;        // of the text that refers to it
  std::string given_path;  // of a file, as the user gave it
  int priority = 0;
  const vrml::Node* node = nullptr;  // that it is for; null: none, or several
  std::shared_ptr<Taker> taker;
  std::uint64_t max_bytes = kNoLimit;  // what lies behind never comes, and nobody misses it
  bool cut = false;                    // there was more

  // While it is being read.
  std::string content_type;
  net::Validator validator;
  bool front = false;  // only the first bytes are asked for yet
  net::RequestId request;
  std::string first_problem;
  bool told = false;      // it is one that was said already of another
  std::string reference;  // as the text has it, for messages
  std::optional<net::MappedFile> file;
  std::vector<std::byte> data;  // of a data: URL
  std::span<const std::byte> rest;
  bool begun = false, refused = false;
  std::uint64_t received = 0;
  std::optional<std::uint64_t> total;

  static constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};
};

/// Whose turn it is.
enum class Urgency : int { texture = 0, vectors = 1, inline_scene = 2, prototypes = 3, world = 4 };
/// Of the loader's priorities between two urgencies; in between, how large something is seen.
inline constexpr int kUrgencyStep = 1000;
inline constexpr std::chrono::milliseconds kLongestWait{1000};  // so that a limit is noticed
/// So much of a file tells its type.
inline constexpr std::size_t kTypeBytes = 4096;
/// Of a long stream on a server, before views choose.
inline constexpr std::uint64_t kFrontBytes = std::uint64_t{1} << 16;

class SceneTaker;
class CloudTaker;
class OutlineReader;

/// What the thread waits on.
class Waker {
 public:
  void wake();
  void wait(std::chrono::milliseconds time);

 private:
  std::mutex mutex_;
  std::condition_variable something_;
  bool awake_ = false;  // guarded by mutex_
};

/// What a message says of urls none of which works; `why`: the trouble with the first, or empty.
[[nodiscard]] std::string why_missing(const vrml::MFString& urls, const std::string& why);

struct WorldLoading::State {
  State(const std::string& asked, const LoadOptions& options);
  ~State();

  // world_loading.cpp
  void start();
  bool step(std::chrono::milliseconds wait);
  void fetch(std::unique_ptr<Fetch> fetch, Urgency urgency);
  void begin_next_candidate(Fetch& fetch);
  void ask(Fetch& fetch, std::vector<net::ByteRange> ranges);
  bool take_front(Fetch& fetch, const net::LoadHead& head);
  void take_rest(Fetch& fetch);
  bool begin_local(Fetch& fetch, const net::Url& url);
  void local_step();
  bool take_events();
  void take(Fetch& fetch, net::LoadEvent& event);
  void begin_taking(Fetch& fetch, const Found& found);
  void deliver(Fetch& fetch, std::span<const std::byte> bytes);
  void finish(Fetch& fetch, const std::optional<std::string>& problem);
  void stop(const std::string& why);
  void fail_candidate(Fetch& fetch, const std::string& why, const std::string& folder = {});
  bool refuse_folder(const std::string& folder, const std::string& reference);
  void report(vrml::Severity severity, const std::string& file, vrml::SourceLocation at, std::string message) {
    world.diagnostics.add({severity, file, at, std::move(message)});
  }
  void set_priorities();
  /// A QNV node has got (better) vectors.
  void cloud_arrived(Arrivals::Cloud cloud);
  void image_arrived(Arrivals::Image image);
  net::Loader* network();
  // world_cells.cpp
  bool begin_cells(Fetch& fetch, const net::Url& url);
  void open_cells(Fetch& fetch, const net::Url& url);
  bool step_cells();
  void stop_cells(const Fetch* fetch);
  [[nodiscard]] net::CellClientStatistics cell_statistics() const;

  [[nodiscard]] ReadFile reader_of(const net::Origin& origin);
  BytesResult read_now(const std::string& url, const net::Origin& from);

  LoadOptions options;
  net::ReferencePolicy policy;
  LoadLimit limit;
  WorldBudget budget;
  OpenedWorld world;                                        // once it was taken: only what goes with the arrivals
  Arrivals arrivals;                                        // since then
  std::unordered_map<const vrml::Node*, float> importance;  // likewise, as the owner of the world sees it
  render::MeshCache meshes;
  std::shared_ptr<SceneTaker> root;
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  glm::vec3 viewer{0, 0, 10};

  std::unique_ptr<net::Loader> loader;  // made when something of the network is wanted
  std::unordered_map<std::uint64_t, Fetch*> by_request;
  std::vector<std::unique_ptr<Fetch>> fetches;  // not at their end
  std::deque<Fetch*> local;                     // that are read here, one after the other
  std::vector<Fetch*> ended;
  std::vector<std::unique_ptr<RangedStream>> streams;
  /// A resource that comes as cells.
  struct Cells;
  std::vector<std::shared_ptr<Cells>> cells;
  std::deque<Fetch*> waiting_cells;                // that documents ask for
  std::unordered_set<std::string> silent_servers;  // that were asked for cells, and never answered
  net::CellClientStatistics ended_cells;           // of those that are over
  std::deque<net::LoadEvent> events;               // that were polled and not taken in yet
  std::size_t files = 0;
  std::uint64_t received = 0;
  bool too_many_files = false, stopped = false, is_done = false, changed = false, fed = false, taken = false;
  std::chrono::steady_clock::time_point next_priorities;

  // Things that several nodes refer to, by what they ask for.
  struct SharedImage;
  struct SharedCloud;
  struct OutlineTaker;
  std::unordered_map<std::string, std::shared_ptr<SharedImage>> shared_images;
  std::unordered_map<std::string, std::shared_ptr<SharedCloud>> shared_clouds;

  std::shared_ptr<Waker> waker = std::make_shared<Waker>();
};

/// Makes a scene of the bytes of a file of any type, as they come, and has what it refers to read.
class SceneTaker final : public Taker, public std::enable_shared_from_this<SceneTaker> {
 public:
  enum class Role : std::uint8_t { root, inlined, library };
  using World = WorldLoading::State;

  SceneTaker(World& world, Role role, SceneTaker* outer);
  bool makes_nodes() const override { return true; }
  bool begin(const Found& found) override;
  bool whole_file(const net::MappedFile& file, const std::string& path) override;
  void more(std::span<const std::byte> bytes) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;
  bool seek(RangedStream::Place place) override;
  void piece(const net::CellEvent& event) override;
  std::shared_ptr<StreamFeed> follow() override;

  /// Drops meshes of nodes that are still being read.
  void forget_open(render::MeshCache& meshes);
  /// The scene of the root, which nobody feeds any more. Null: there is nothing to show.
  [[nodiscard]] std::unique_ptr<vrml::SceneGraph> release();
  void set_cloud(vrml::NodeId id, const std::shared_ptr<const qnv::Cloud>& cloud);
  /// An OutlineGroup that has got more polygons.
  void outlines_changed(vrml::NodeId id);
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] double seconds() const { return seconds_; }

  Role role;
  SceneTaker* outer;                   // whose Inline or EXTERNPROTO this is; null: the root
  vrml::NodeId inline_node;            // of outer's scene
  std::string place_file;              // where outer's node is, for messages
  vrml::SourceLocation place;          // in that file
  std::string what;                    // "Inline", "EXTERNPROTO Name", for messages
  vrml::MFString urls;                 // where it may be, for messages
  std::vector<vrml::NodeType*> types;  // library: outer's types that wait for it
  std::vector<std::string> fragments;  // of each
  vrml::SceneGraph* scene = nullptr;
  bool refused = false, whole = true;

 private:
  // scene_taker.cpp
  bool choose_type(bool last);
  void read_rest(std::span<const std::byte> bytes);
  [[nodiscard]] CloudTaker& cloud_taker();
  void read_mesh(std::span<const std::byte> bytes);
  void show_outlines();
  void end_text(bool had_problem);
  void complete_outlines();
  void finished_reading();
  void show_cloud(const std::shared_ptr<const qnv::Cloud>& cloud);
  void attach();
  void settle();
  [[nodiscard]] bool leads_back(const Found& found) const;
  // scene_references.cpp
  /// What a url list names, and in whose name it is asked for.
  struct Reference {
    std::vector<net::Url> places;
    net::Origin from;
    std::string first;  // as the text has it
  };
  [[nodiscard]] Reference refer(const vrml::MFString& list, const vrml::SceneGraph& text) const;
  [[nodiscard]] Reference refer(vrml::NodeId id) const;
  void ask_for(Reference reference, vrml::NodeId id, std::shared_ptr<Taker> taker, Urgency urgency);
  void look_for_references();
  void visit(vrml::NodeId id);
  void look_for_prototypes();
  void visit_inline(vrml::NodeId id);
  void visit_image(vrml::NodeId id);
  void visit_cloud(vrml::NodeId id);
  void visit_outlines(vrml::NodeId id);
  void replace_fallback(vrml::NodeId id);
  void take_library(SceneTaker& library);
  void take_prototype(vrml::NodeType& type, const vrml::NodeType& source, const std::string& file);
  void resolve_types();
  void report(vrml::Severity severity, vrml::SourceLocation at, std::string message) {
    world_.report(severity, scene ? scene->file_name() : found_.path, at, std::move(message));
  }
  void report_at(const vrml::Node& node, std::string message) {
    world_.report(vrml::Severity::warning, node.text->file_name(), node.location, std::move(message));
  }

  World& world_;
  Found found_;
  std::unique_ptr<vrml::SceneGraph> own_;                             // until it is attached or handed over
  std::unordered_map<const vrml::SceneGraph*, net::Origin> origins_;  // of this text, and of libraries'
  std::vector<std::byte> waiting_;  // bytes that came before the type was known, or all of a file read at once
  vrml::Share waiting_share_;
  const ContentType* type_ = nullptr;
  std::optional<vrml::Parser> parser_;
  std::unique_ptr<Gunzip> gunzip_;
  std::shared_ptr<CloudTaker> cloud_taker_;
  std::unique_ptr<OutlineReader> outlines_;  // of a file that is a stream of outlines
  vrml::NodeId cloud_node_;
  std::uint32_t looked_at_ = 0;
  std::vector<vrml::NodeId> later_;  // nodes whose fields were not all read yet
  std::vector<std::shared_ptr<SceneTaker>> libraries_, inner_;
  std::vector<const vrml::Node*> shown_open_;  // nodes that were being read when they were shown
  std::unordered_set<std::uint32_t> open_;     // indices of nodes that are being read
  std::unordered_set<const vrml::NodeType*> used_types_, asked_types_;
  std::vector<std::pair<vrml::NodeType*, const vrml::NodeType*>> to_resolve_;  // EXTERNPROTO, PROTO
  std::unordered_map<std::uint32_t, vrml::NodeId> fallbacks_;  // by the QNV node that may take its place
  std::size_t awaited_libraries_ = 0, bytes_ = 0, errors_before_ = 0;
  double seconds_ = 0;
  bool is_gzip_known_ = false, whole_file_read_ = false, text_ended_ = false, settled_ = false;
};

/// Reads a stream of outlines into nodes of a scene, as it comes.
class OutlineReader {
 public:
  /// `node`: an OutlineGroup that takes all polygons; null: Shapes of the scene's own.
  OutlineReader(WorldLoading::State& world, vrml::SceneGraph& scene, vrml::NodeId node = {})
      : world_(world), outlines_(scene, world.world.diagnostics, node) {}

  void more(std::span<const std::byte> bytes);
  void piece(const net::CellEvent& event);
  /// `whole`: nothing is missing that might still come.
  void end(const std::string& file, bool whole);
  /// Nodes that have got more polygons since this was last asked.
  [[nodiscard]] std::vector<vrml::NodeId> take_changed();
  [[nodiscard]] bool empty() const { return outlines_.nodes().empty(); }

 private:
  void show();

  WorldLoading::State& world_;
  qnv::OutlineDecoder decoder_;
  OutlineScene outlines_;
  bool changed_ = false;
};

/// Makes vectors of the bytes of a QNV stream, a volume or another program's splats, as they come.
class CloudTaker final : public Taker {
 public:
  using World = WorldLoading::State;
  /// Called with every better state of the cloud.
  using Show = std::function<void(const std::shared_ptr<const qnv::Cloud>&)>;
  /// For whom it is, for messages.
  struct Place {
    std::string file;
    vrml::SourceLocation location;
    vrml::MFString urls;
    bool is_node = false;  // a QNV node; else the world itself
  };
  CloudTaker(World& world, Place place, Show show);
  bool begin(const Found& found) override;
  bool whole_file(const net::MappedFile& file, const std::string& path) override;
  void more(std::span<const std::byte> bytes) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;
  bool seek(RangedStream::Place place) override;
  void piece(const net::CellEvent& event) override;
  std::shared_ptr<StreamFeed> follow() override { return way_ == Way::pushed ? feed_ : nullptr; }

 private:
  enum class Way : std::uint8_t { unknown, pushed, decoded, whole, done };
  void choose_way();
  void start_feed(std::shared_ptr<qnv::LodStream> stream);
  void show_records(bool last);
  void read_bytes();
  void read_whole(std::span<const std::byte> bytes, const std::string& path);
  void report_problems(const std::vector<qnv::StreamProblem>& problems, vrml::Severity severity);
  /// What was refused is left out, and nothing more is taken.
  void give_up(vrml::Resource resource);
  bool count_decoded();

  World& world_;
  Place place_;
  Show show_;
  Found found_;
  Way way_ = Way::unknown;
  std::vector<std::byte> bytes_;
  vrml::Share held_bytes_, decoded_;
  std::shared_ptr<StreamFeed> feed_;
  std::unique_ptr<qnv::StreamDecoder> decoder_;
  std::size_t shown_ = 0;
  std::uint64_t directory_ = 0;  // of a packed stream: where it begins; 0: unknown
};

}  // namespace gs::app
