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
  net::Url url;      // after redirects, without fragment
  std::string path;  // of a local file; otherwise the URL. Diagnostics use it as the file name.
  std::string fragment;
  bool local = false;
  net::Origin origin;  // origin of the references of its text
};

class SceneHandler;

/// Interface for the receiver of the bytes of one resource.
class ContentHandler {
 public:
  ContentHandler() = default;
  /// Returns the handler of the scene that this handler adds nodes to, or null. That scene, or the Inline's content,
  /// cannot be handed over while the handler runs.
  [[nodiscard]] virtual const SceneHandler* makes_nodes_of() const { return nullptr; }
  ContentHandler(const ContentHandler&) = delete;
  ContentHandler& operator=(const ContentHandler&) = delete;
  virtual ~ContentHandler() = default;
  /// Announces the resource; its bytes follow from the start. Returns false if they are not wanted.
  virtual bool begin(const Found& found) = 0;
  /// Checks the first bytes of a large local file before it is mapped. Returns the reason to refuse it, or nullopt.
  virtual std::optional<std::string> refuse_first(const std::string& /*path*/, std::span<const std::byte>) {
    return std::nullopt;
  }
  /// Reads a local file as a whole. Returns false to receive it in pieces instead.
  virtual bool whole_file(const net::MappedFile&, const std::string&) { return false; }
  /// Like whole_file(), but may take ownership of the mapping; returns false if it did not.
  virtual bool take_file(net::MappedFile&) { return false; }
  virtual void receive(std::span<const std::byte> bytes) = 0;
  /// Ends the resource. `problem` is the reason why the rest is missing, or nullopt if it is complete.
  virtual void end(const std::optional<std::string>& problem) = 0;
  /// Returns, after `end`, why the content is unusable, so that the next candidate is tried. Returns nullopt if it is
  /// usable.
  virtual std::optional<std::string> wants_next() { return std::nullopt; }
  /// Reports that no candidate has usable content.
  virtual void missing(const std::string& why) = 0;
  /// Decides whether to read the rest by ranges from `place` instead of front to back. If it returns true, neither more
  /// bytes nor `end` follow.
  virtual bool seek(RangedStream::Place) { return false; }
  /// Receives a chunk, or some records of one, from cells after the protected base.
  virtual void receive_cells(const net::CellEvent&) {}
  /// Returns a feed if the front is enough and views request the rest. Otherwise returns null. After a feed, neither
  /// more bytes nor `end` follow.
  virtual std::shared_ptr<StreamFeed> follow() { return nullptr; }

  /// Reports that reading was stopped on purpose. `end` or `missing` came before.
  virtual void stopped() {}
  /// Reports the fraction that was received, 0 to 1.
  virtual void tell_progress(double) {}

  bool cut = false;   // bytes after `--max-bytes` were omitted on purpose
  bool told = false;  // the reason of a missing resource was already reported
};

/// Number of first bytes that suffice to detect the type of a file.
inline constexpr std::size_t kTypeBytes = 4096;

}  // namespace gs::app
