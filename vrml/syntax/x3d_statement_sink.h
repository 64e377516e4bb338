#pragma once

#include "base/noncopyable.h"
#include "vrml/scene/x3d/x3d_statements.h"

#include <string>
#include <string_view>

namespace gs::vrml {

class SceneSink;
struct RouteNames;
struct SourceName;

/// Part of SceneSink for the statements of X3D (ISO/IEC 19775-1 7.2.5). Stores them in SourceText::x3d(). Names and
/// values may come from untrusted text. One thread.
class X3DStatementSink : NonCopyable {
 public:
  explicit X3DStatementSink(SceneSink& sink) : sink_(sink) {}

  /// Makes the text an X3D text of this version, in tenths: 33 for X3D 3.3. Reports versions that do not exist. Call it
  /// before all other functions of the sink.
  void set_version(int tenths, SourceLocation location);
  /// Sets the profile. Reports a profile that is unknown or not completely supported.
  void set_profile(SourceName name);
  /// Adds a component. Reports a component that is unknown, unsupported, or only supported at a lower level.
  void add_component(SourceName name, int level);
  void add_meta(std::string_view name, std::string_view content, SourceLocation location);
  /// Sets a unit. Values that follow are converted (see Measure), or scaled by the Inlines of the text (length).
  void set_unit(SourceName category, std::string_view name, double factor);
  /// Adds an IMPORT. `inline_name` is the DEF name of an Inline, which may follow later. An empty `local` means
  /// `exported`.
  void import_node(SourceName inline_name, std::string_view exported, std::string_view local);
  /// Adds an EXPORT. `local` is a DEF name or imported name, which may follow later. An empty `exported` means `local`.
  void export_node(SourceName local, std::string_view exported);

 private:
  friend class SceneSink;
  friend class RouteSink;
  [[nodiscard]] X3DStatements& statements();
  [[nodiscard]] bool admit(std::size_t bytes);
  [[nodiscard]] bool is_imported(std::string_view name) const;
  /// Returns the statements of the scope: of the text, or of the PROTO with this body.
  [[nodiscard]] X3DStatements& shared();
  /// Takes a ROUTE if one of its nodes is imported. Returns false if none is.
  [[nodiscard]] bool take_route(const RouteNames& route);
  /// Finds the nodes of IMPORT and EXPORT statements. Called at the end of the text.
  void resolve_names();

  SceneSink& sink_;
  bool said_prototype_ = false;
};

}  // namespace gs::vrml
