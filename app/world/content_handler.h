#pragma once

#include "app/base/read_file.h"
#include "app/streams/ranged_stream.h"
#include "app/streams/stream_feed.h"
#include "net/base/reference_policy.h"
#include "net/base/url.h"
#include "net/cells/cell_receiver.h"
#include "net/files/file.h"
#include "net/load/loader.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

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
class SceneHandler;

/// Takes the bytes of one resource.
class ContentHandler {
 public:
  ContentHandler() = default;
  /// Whose nodes it changes; null: nobody's. While one does, the world, or the Inline's content, cannot be given away.
  [[nodiscard]] virtual const SceneHandler* makes_nodes_of() const { return nullptr; }
  ContentHandler(const ContentHandler&) = delete;
  ContentHandler& operator=(const ContentHandler&) = delete;
  virtual ~ContentHandler() = default;
  /// The resource is there, and its bytes will come from the start. False: not wanted.
  virtual bool begin(const Found& found) = 0;
  /// Checks the first bytes of a large local file before it is mapped. Returns why it must not be, or nullopt.
  virtual std::optional<std::string> refuse_first(const std::string& /*path*/, std::span<const std::byte>) {
    return std::nullopt;
  }
  /// A local file, to be read as a whole at once. False: it should rather come in pieces.
  virtual bool whole_file(const net::MappedFile&, const std::string&) { return false; }
  /// Likewise, and it is moved by who is to have it for longer. False: it was left alone.
  virtual bool take_file(net::MappedFile&) { return false; }
  virtual void receive(std::span<const std::byte> bytes) = 0;
  /// All is there (`problem` empty), or what is missing never comes.
  virtual void end(const std::optional<std::string>& problem) = 0;
  /// After `end`: why what came is of no use, so that the next place is to be tried. Nothing: it is.
  virtual std::optional<std::string> wants_next() { return std::nullopt; }
  /// None of the places where it might be has it, or what of use it has.
  virtual void missing(const std::string& why) = 0;
  /// Whether the rest, behind the front that has come, is better read here and there, as `place` says. True: it is
  /// seen to, and neither more bytes nor an end come.
  virtual bool seek(RangedStream::Place) { return false; }
  /// Of cells, behind the base: a chunk, or some of the records of one.
  virtual void receive_cells(const net::CellEvent&) {}
  /// Whether what is there is enough, and views see to the rest by a feed. Null: no; else neither more nor an end come.
  virtual std::shared_ptr<StreamFeed> follow() { return nullptr; }

  /// So much of it has come, 0 to 1.
  virtual void tell_progress(double) {}

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
  std::shared_ptr<ContentHandler> handler;
  std::uint64_t max_bytes = kNoLimit;  // what lies behind never comes, and nobody misses it
  bool cut = false;                    // there was more

  // While it is being read.
  std::string content_type;
  net::Validator validator;
  /// What of it is asked for.
  enum class Part : std::uint8_t { all, front };
  Part part = Part::all;
  net::RequestId request;
  std::string first_problem;
  bool told = false;      // it is one that was said already of another
  std::string reference;  // as the text has it, for messages
  std::optional<net::MappedFile> file;
  std::vector<std::byte> data;  // of a data: URL
  std::span<const std::byte> rest;
  enum class Stage : std::uint8_t {
    seeking,    // no candidate has had it yet
    receiving,  // its bytes go to the handler
    refused,    // the handler does not want them
  };
  Stage stage = Stage::seeking;
  std::uint64_t received = 0;
  std::optional<std::uint64_t> total;
  std::uint64_t row = 0;  // of the LoadLedger

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

}  // namespace gs::app
