#pragma once

#include "app/loading/content/scene_context.h"
#include "app/loading/fetch/fetch.h"
#include "app/loading/updates/resource_updates.h"
#include "vrml/scene/scene_graph.h"

#include <memory>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::app {

class SceneHandler;

/// Returns the key of a resource: fetches with the same key are shared. Texts of different sites never share a fetch,
/// because their permissions differ.
[[nodiscard]] std::string fetch_key(const std::vector<net::Url>& places, const net::Origin& from);

/// References of the nodes of a scene: finds their urls, and fetches them for the handler of their kind of content.
class SceneReferences {
 public:
  /// Candidate URLs of a url list, with the origin that requests them.
  struct Reference {
    std::vector<net::Url> places;
    net::Origin from;
    std::string first;     // first URL as written in the text
    bool refresh = false;  // UrlRequest::refresh
  };

  SceneReferences(SceneHandler& handler, SceneContext& context) : handler_(handler), context_(context) {}

  /// Resolves a url list of a text in this world. Tries relative URLs in the folder of the scene's file first, then in
  /// that of the text (VRML97 4.5.3). For a text that was read from a URL at run time, the order is reversed.
  [[nodiscard]] Reference refer(const vrml::MFString& list, const vrml::SourceText& text) const {
    return refer(list, text.source(), false);
  }
  [[nodiscard]] Reference refer(const vrml::MFString& list, const std::shared_ptr<const vrml::TextSource>& source,
                                bool own_file_first) const;
  void ask_for(Reference reference, const vrml::Node* node, std::shared_ptr<ContentHandler> handler, Urgency urgency);

  /// Fetches the urls of nodes that were added since the last call.
  void look();
  /// Fetches the urls of a node of the running world that were set. The node keeps its present content until new
  /// content is available or missing.
  void load(const UrlRequest& request);
  /// Gives vectors to a QNV node.
  void set_geometry(vrml::NodeId id, const std::shared_ptr<const qnv::Geometry>& geometry);
  /// Returns the handlers of the Inlines.
  [[nodiscard]] const std::vector<std::shared_ptr<SceneHandler>>& inlines() const { return inlines_; }

 private:
  [[nodiscard]] vrml::SceneGraph& scene() const;
  [[nodiscard]] Reference refer(vrml::NodeId id) const;
  [[nodiscard]] std::vector<net::Url> below_folders(const net::Url& base, const net::Url& rooted,
                                                    const net::Origin& from) const;
  [[nodiscard]] UrlRequest request_of(vrml::NodeId id, vrml::MFString urls) const;
  void visit(vrml::NodeId id);
  void visit_inline(vrml::NodeId id);
  void visit_images(vrml::NodeId id);
  void visit_geometry(vrml::NodeId id);
  void visit_outlines(vrml::NodeId id);
  void visit_script(vrml::NodeId id);
  void replace_fallback(vrml::NodeId id, const vrml::NodeType& native);
  void load_inline(const UrlRequest& request, Reference reference);
  void ask_for_inline(const UrlRequest& request, Reference reference, bool withheld);
  void ask_for_image(const UrlRequest& request, Reference reference, bool again);
  void ask_for_media(const UrlRequest& request, Reference reference);

  SceneHandler& handler_;
  SceneContext& context_;
  std::uint32_t looked_at_ = 0;
  std::vector<vrml::NodeId> later_;  // nodes to visit again, because fields are incomplete
  std::vector<std::shared_ptr<SceneHandler>> inlines_;
  std::unordered_set<std::uint32_t> open_;                     // indices of nodes with incomplete fields
  std::unordered_map<std::uint32_t, vrml::NodeId> fallbacks_;  // PROTO instances, by index of the new QNV node
};

}  // namespace gs::app
