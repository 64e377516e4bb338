#pragma once

#include "app/formats/content_types.h"
#include "app/loading/content/scene_content.h"
#include "app/loading/content/scene_context.h"
#include "app/loading/content/scene_prototypes.h"
#include "app/loading/content/scene_references.h"
#include "app/loading/content/scene_target.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Reference for which a scene is read.
struct SceneUse {
  enum class Role : std::uint8_t { root, inlined, library };
  Role role = Role::root;
  SceneHandler* outer = nullptr;  // handler of the scene with the Inline or EXTERNPROTO; null for the root
  UrlRequest request;             // of the Inline; of an EXTERNPROTO for messages only
  /// An Inline of the running world gets the content when it is read. Otherwise it is attached to `outer` at once.
  bool is_withheld = false;
};

/// Content handler that reads a scene from a file of any type while its bytes are received. Also fetches the references
/// of the scene.
class SceneHandler final : public ContentHandler, public std::enable_shared_from_this<SceneHandler> {
 public:
  using Role = SceneUse::Role;

  SceneHandler(SceneContext& context, SceneUse use);
  ~SceneHandler() override;
  [[nodiscard]] const SceneHandler* makes_nodes_of() const override { return this; }
  bool begin(const Found& found) override;
  std::optional<std::string> refuse_first(const std::string& path, std::span<const std::byte> first) override {
    return refuse_first_bytes(path, first);
  }
  bool whole_file(const net::MappedFile& file, const std::string& path) override;
  void receive(std::span<const std::byte> bytes) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;
  void stopped() override;
  void receive_piece(const net::CellEvent& event) override;
  [[nodiscard]] bool has_more() const override { return content_ && !target_.refused() && content_->has_more(); }
  void read_more() override;
  std::shared_ptr<StreamFeed> feed() override { return content_ ? content_->feed() : nullptr; }
  void leave_to_feed() override { finished_reading(); }
  bool take_parts(const PartsOffer& offer) override;

  [[nodiscard]] const SceneUse& use() const { return use_; }
  [[nodiscard]] SceneTarget& target() { return target_; }
  [[nodiscard]] const SceneTarget& target() const { return target_; }
  [[nodiscard]] SceneReferences& references() { return references_; }
  [[nodiscard]] ScenePrototypes& prototypes() { return prototypes_; }
  /// Returns true if the file itself has ended or failed. Its references may still be loading.
  [[nodiscard]] bool nothing_more_comes() const { return stage_ >= Stage::ended; }
  /// Returns true if the file of a library and its references have been loaded.
  [[nodiscard]] bool is_settled() const { return stage_ == Stage::settled; }
  /// Returns the nodes that are still being read.
  [[nodiscard]] std::vector<vrml::NodeId> open_nodes() const;
  /// Returns the number of bytes of the file that were read or received.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Returns the counter of further bytes of a file that is read by parts; null for other files.
  [[nodiscard]] const std::shared_ptr<const std::atomic<std::uint64_t>>& parts() const { return parts_; }
  [[nodiscard]] double seconds() const { return seconds_; }
  /// Returns the unit of length of the text, in metres (X3D UNIT).
  [[nodiscard]] double length_unit() const { return length_unit_; }

  // Hands this library to the scene with the EXTERNPROTO after all libraries that it uses are loaded.
  void settle();
  /// Withholds the content from the Inline until it is read.
  void withhold() { use_.is_withheld = true; }
  /// Returns true if `top` is this handler or one of its outer handlers.
  [[nodiscard]] bool is_inside(const SceneHandler& top) const;

 private:
  bool choose_type(bool last);
  bool begin_step(std::span<const std::byte> series);
  bool begin_file_of_list(std::span<const std::byte> list);
  void read_instead(std::vector<net::Url> candidates);
  void read_rest(std::span<const std::byte> bytes);
  void finished_reading();
  void attach();

  SceneContext& context_;
  SceneUse use_;
  SceneTarget target_;
  SceneReferences references_;
  ScenePrototypes prototypes_;
  std::vector<std::byte> waiting_;  // bytes before the type is known, and those of a series or a list
  Share waiting_share_;
  const ContentType* type_ = nullptr;
  bool is_series_ = false, is_step_ = false;  // the root is a series in JSON or a list; a file of these
  std::unique_ptr<Fetch> step_;               // fetch of a step, until the series has ended
  std::unique_ptr<SceneContent> content_;     // null before the type is known and after the end
  std::size_t bytes_ = 0, errors_before_ = 0;
  std::shared_ptr<const std::atomic<std::uint64_t>> parts_;
  double seconds_ = 0, length_unit_ = 1;
  enum class Stage : std::uint8_t {
    receiving,
    read_at_once,  // whole_file() has read the complete file
    ended,         // the file itself has ended
    settled,       // the libraries that the file uses are loaded too
  };
  Stage stage_ = Stage::receiving;
};

// Hand-over to the running world, which owns the scenes from then on and receives the rest as updates. Inlines with
// incomplete files are withheld, to be given later.

/// Gives the root scene, complete or not. Returns null if there is nothing to show.
[[nodiscard]] std::unique_ptr<vrml::SceneGraph> give_root(SceneHandler& root, SceneContext& context);
/// Gives the content of an Inline. Returns null if there is nothing to show.
[[nodiscard]] std::shared_ptr<vrml::SceneGraph> give_content(SceneHandler& handler, SceneContext& context);
/// Gives a library with its references.
[[nodiscard]] std::unique_ptr<vrml::SceneGraph> give_library(SceneHandler& library, SceneContext& context);
/// Returns the handler of a scene among `handler` and its Inlines, or null.
[[nodiscard]] SceneHandler* handler_of(SceneHandler& handler, const vrml::SceneGraph* wanted);
/// Drops meshes of nodes that are still being read, also those of Inlines.
void forget_open(SceneHandler& handler, render::MeshCache& meshes);

}  // namespace gs::app
