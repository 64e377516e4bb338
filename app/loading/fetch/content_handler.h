#pragma once

#include "app/base/read_file.h"
#include "app/streams/ranged_stream.h"
#include "app/streams/stream_feed.h"
#include "net/base/reference_policy.h"
#include "net/base/url.h"
#include "net/cells/cell_receiver.h"
#include "net/files/file.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Location at which the bytes of a resource were found.
struct Found {
  net::Url url;      // URL after redirects, without the fragment
  std::string path;  // path of a local file, else the URL; the file name in diagnostics
  std::string fragment;
  std::size_t candidate = 0;  // index of the URL among those of the reference
  bool local = false;
  net::Origin origin;  // origin of all references inside the resource
};

class SceneHandler;
struct PartsOffer;

/// Interface for the receiver of the bytes of one resource.
class ContentHandler {
 public:
  ContentHandler() = default;
  /// Returns the handler of the scene that gets nodes from this handler, or null. While this handler runs, neither that
  /// scene nor an Inline's content can be handed over.
  [[nodiscard]] virtual const SceneHandler* makes_nodes_of() const { return nullptr; }
  ContentHandler(const ContentHandler&) = delete;
  ContentHandler& operator=(const ContentHandler&) = delete;
  virtual ~ContentHandler() = default;
  /// Announces the resource. The caller then passes its bytes from the first on. Returns false to refuse the bytes.
  virtual bool begin(const Found& found) = 0;
  /// Checks the first bytes of a large local file before the file is mapped. Returns the reason for refusing it, or
  /// nullopt.
  virtual std::optional<std::string> refuse_first(const std::string& /*path*/, std::span<const std::byte>) {
    return std::nullopt;
  }
  /// Reads a local file as a whole. Returns false if `receive` must get the file in pieces instead.
  virtual bool whole_file(const net::MappedFile&, const std::string&) { return false; }
  /// Like whole_file(), but may move from the mapping. Returns false if the mapping still belongs to the caller.
  virtual bool take_file(net::MappedFile&) { return false; }
  virtual void receive(std::span<const std::byte> bytes) = 0;
  /// Ends the resource. `problem` states why the remaining bytes are missing; nullopt means that the resource is
  /// complete.
  virtual void end(const std::optional<std::string>& problem) = 0;
  /// Returns true if work is left after `end`, such as finer versions that the content itself reads.
  [[nodiscard]] virtual bool has_more() const { return false; }
  /// Does a part of that work. Called once per step of the loading while `has_more` returns true.
  virtual void read_more() {}
  /// Returns the reason why the content is unusable, or nullopt. With a reason, the caller tries the next candidate.
  /// Called after `end`.
  virtual std::optional<std::string> wants_next() { return std::nullopt; }
  /// Reports that no candidate has usable content.
  virtual void missing(const std::string& why) = 0;
  /// Receives a chunk, or some records of a chunk, in any order. Called after the first bytes were received: the
  /// protected base of cells, or the front of a stream that is read by ranges.
  virtual void receive_piece(const net::CellEvent&) {}
  /// Returns the feed through which views request chunks of the stream, or null. If StreamFeed::takes_bytes, the caller
  /// may call leave_to_feed(); else this handler receives the chunks.
  virtual std::shared_ptr<StreamFeed> feed() { return nullptr; }
  /// Reports that the feed takes all further bytes. The caller passes no more bytes and does not call `end`.
  virtual void leave_to_feed() {}

  /// Offers the rest of a resource by parts, after its first bytes were received. Returns false to receive the rest in
  /// order. If it returns true, the caller passes no more bytes and calls `end`.
  virtual bool take_parts(const PartsOffer&) { return false; }

  /// Reports that reading was stopped on purpose. `end` or `missing` came before.
  virtual void stopped() {}
  /// Reports the fraction of the bytes that was received, 0 to 1.
  virtual void tell_progress(double) {}

  bool cut = false;   // bytes after `--max-bytes` were omitted on purpose
  bool told = false;  // the diagnostics already say why the resource is missing
};

/// Number of first bytes that suffice to detect the type of a file.
inline constexpr std::size_t kTypeBytes = 4096;

}  // namespace gs::app
