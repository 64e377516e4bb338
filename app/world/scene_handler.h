#pragma once

#include "app/base/text_source.h"
#include "app/formats/content_types.h"
#include "app/world/cloud_handler.h"
#include "app/world/outline_reader.h"
#include "app/world/updates/external_prototypes.h"
#include "app/world/world_loading_state.h"
#include "base/gzip.h"
#include "vrml/syntax/parser.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gs::app {

/// Returns the key under which fetches are shared. Texts of different sites never share a fetch, because their
/// permissions differ.
[[nodiscard]] std::string fetch_key(const std::vector<net::Url>& places, const net::Origin& from);

/// Content handler that reads a scene from a file of any type while its bytes are received, and fetches its references.
class SceneHandler final : public ContentHandler, public std::enable_shared_from_this<SceneHandler> {
 public:
  enum class Role : std::uint8_t { root, inlined, library };
  using World = WorldLoading::State;

  SceneHandler(World& world, Role role, SceneHandler* outer);
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
  bool seek(RangedStream::Place place) override;
  void receive_cells(const net::CellEvent& event) override;
  std::shared_ptr<StreamFeed> follow() override;

  /// Drops meshes of nodes that are still being read.
  void forget_open(render::MeshCache& meshes);
  /// Hands over the root scene once it is complete or can no longer be completed. Returns null if there is nothing to
  /// show. The running world owns the scene from then on and receives the rest as updates, including Inlines that are
  /// still being read.
  [[nodiscard]] std::unique_ptr<vrml::SceneGraph> give_root();
  /// Hands over the content of an Inline that was `given_to` a running world. Returns null if there is nothing to show.
  [[nodiscard]] std::shared_ptr<vrml::SceneGraph> give_content();
  void set_cloud(vrml::NodeId id, const std::shared_ptr<const qnv::Geometry>& cloud);
  /// Notes that an OutlineGroup has more polygons.
  void outlines_changed(vrml::NodeId id);
  /// Fetches the urls of a node of the running world that were set.
  void load(const UrlRequest& request);
  /// Returns the handler of a scene among this one and its inner handlers, or null.
  [[nodiscard]] SceneHandler* handler_of(const vrml::SceneGraph* wanted);
  /// Returns true if `top` or one of its references reads this resource.
  [[nodiscard]] bool is_inside(const SceneHandler& top) const;
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] double seconds() const { return seconds_; }

  Role role;
  SceneHandler* outer;                     // handler of the scene with the Inline or EXTERNPROTO; null for the root
  vrml::NodeId inline_node;                // in the scene of `outer`
  std::string place_file;                  // file of the node in `outer`, for messages
  SourceLocation place;                    // in that file
  std::string what;                        // "Inline" or "EXTERNPROTO Name", for messages
  vrml::MFString urls;                     // candidate URLs, for messages
  std::vector<AwaitedPrototype> awaiting;  // for a library: types of `outer` that wait for it
  vrml::SceneGraph* scene = nullptr;
  std::optional<Arrivals::Place> given_to;  // Inline of a running world that gets the content when it is read
  /// Completeness of the file itself.
  enum class Content : std::uint8_t { whole, cut_short, refused };
  Content content = Content::whole;
  [[nodiscard]] bool refused() const { return content == Content::refused; }
  /// Returns true if the file itself has ended. Its references may still be loading.
  [[nodiscard]] bool nothing_more_comes() const { return stage_ >= Stage::ended; }

 private:
  // scene_handler.cpp
  bool choose_type(bool last);
  void note_type();
  void read_rest(std::span<const std::byte> bytes);
  void parse(std::span<const std::byte> bytes);
  [[nodiscard]] CloudHandler& cloud_handler();
  void read_mesh(std::span<const std::byte> bytes);
  void show_outlines();
  void end_text(bool had_problem);
  void complete_outlines();
  void finished_reading();
  void show_cloud(const std::shared_ptr<const qnv::Geometry>& cloud);
  void attach();
  void settle();
  void give_away();
  void cut_short() { content = refused() ? Content::refused : Content::cut_short; }
  [[nodiscard]] ReportAt reporter() {
    return
        [this](Severity severity, SourceLocation at, std::string message) { report(severity, at, std::move(message)); };
  }
  [[nodiscard]] bool leads_back(const Found& found) const;
  // scene_references.cpp
  /// Candidate URLs of a url list, with the origin that requests them.
  struct Reference {
    std::vector<net::Url> places;
    net::Origin from;
    std::string first;  // as the text writes it
  };
  /// Resolves a url list of a text of this world. Tries relative URLs beside the scene's file, then beside the file of
  /// the text (VRML97 4.5.3). If the text was read from a URL at run time, tries them beside that URL first.
  [[nodiscard]] Reference refer(const vrml::MFString& list, const vrml::SourceText& text) const {
    return refer(list, text.source(), false);
  }
  [[nodiscard]] Reference refer(const vrml::MFString& list, const std::shared_ptr<const vrml::TextSource>& source,
                                bool own_file_first) const;
  [[nodiscard]] Reference refer(vrml::NodeId id) const;
  [[nodiscard]] std::vector<net::Url> below_folders(const net::Url& base, const net::Url& rooted,
                                                    const net::Origin& from) const;
  void ask_for(Reference reference, const vrml::Node* node, std::shared_ptr<ContentHandler> handler, Urgency urgency);
  void load_inline(const UrlRequest& request, Reference reference);
  void load_prototype(const UrlRequest& request);
  void look_for_references();
  void visit(vrml::NodeId id);
  void visit_inline(vrml::NodeId id);
  void visit_image(vrml::NodeId id);
  void visit_cloud(vrml::NodeId id);
  void visit_outlines(vrml::NodeId id);
  // media_handler.cpp
  void visit_media(vrml::NodeId id);
  void load_media(const UrlRequest& request, Reference reference);
  // scene_programs.cpp
  void visit_script(vrml::NodeId id);
  void load_text(const UrlRequest& request, Reference reference);
  // scene_references.cpp
  void replace_fallback(vrml::NodeId id, const vrml::NodeType& native);
  // scene_prototypes.cpp
  void look_for_prototypes();
  void use_types_inside();
  using Libraries = std::unordered_map<std::string, SceneHandler*>;  // EXTERNPROTOs of one file share one library
  struct PrototypePlace {
    std::string name, file;
    vrml::MFString urls;
  };
  bool ask_for_prototype(AwaitedPrototype& wanted, Reference reference, const PrototypePlace& place, Libraries& fresh);
  void take_library(SceneHandler& library);
  void take_own_prototypes();
  bool stand_in(vrml::NodeType& type);
  void miss_prototypes(const SceneHandler& library, const std::optional<std::string>& why);
  void give_prototypes(std::vector<AwaitedPrototype> awaited, std::unique_ptr<vrml::SceneGraph> library,
                       std::optional<std::string> why);
  void resolve_types();
  void report(Severity severity, SourceLocation at, std::string message) {
    const bool is_own = scene && owner_ == Owner::reader;
    world_.report(severity, is_own ? scene->file_name() : found_.path, at, std::move(message));
  }
  void report_at(const vrml::Node& node, std::string message) {
    world_.report(Severity::warning, node.text->file_name(), node.location, std::move(message));
  }

  World& world_;
  Found found_;
  std::unique_ptr<vrml::SceneGraph> own_;      // until it is attached or handed over
  std::shared_ptr<vrml::SceneGraph> content_;  // content of an attached Inline; taken back to be read on
  std::weak_ptr<vrml::SceneGraph> given_;      // content of an Inline that belongs to the running world
  std::vector<std::byte> waiting_;  // bytes before the type is known, or all bytes of a file that is read at once
  Share waiting_share_;
  const ContentType* type_ = nullptr;
  std::optional<vrml::Parser> parser_;
  std::unique_ptr<Gunzip> gunzip_;  // Packing::gzip
  std::shared_ptr<CloudHandler> cloud_handler_;
  std::unique_ptr<OutlineReader> outlines_;  // for a file that is a stream of outlines
  vrml::NodeId cloud_node_;
  std::uint32_t looked_at_ = 0;
  std::vector<vrml::NodeId> later_;  // nodes with incomplete fields
  std::vector<std::shared_ptr<SceneHandler>> libraries_, inner_;
  std::vector<const vrml::Node*> shown_open_;  // nodes that were incomplete when they were shown
  std::unordered_set<std::uint32_t> open_;     // indices of incomplete nodes
  std::unordered_set<const vrml::NodeType*> used_types_, asked_types_;
  std::vector<std::pair<vrml::NodeType*, const vrml::NodeType*>> to_resolve_;  // EXTERNPROTO, PROTO
  std::vector<std::pair<vrml::NodeType*, std::string>> own_types_;  // EXTERNPROTOs that refer to a PROTO of this file
  std::unordered_map<std::uint32_t, vrml::NodeId> fallbacks_;       // by the QNV node that may replace them
  std::size_t awaited_libraries_ = 0, bytes_ = 0, errors_before_ = 0;
  double seconds_ = 0;
  enum class Packing : std::uint8_t { unknown, plain, gzip };
  Packing packing_ = Packing::unknown;
  enum class Stage : std::uint8_t {
    receiving,
    read_at_once,  // by `whole_file`
    ended,         // the file itself has ended
    settled,       // so have the references of a library
  };
  Stage stage_ = Stage::receiving;
  enum class Owner : std::uint8_t { reader, world_runtime };
  Owner owner_ = Owner::reader;  // owner of the scene, its nodes and types
};

}  // namespace gs::app
