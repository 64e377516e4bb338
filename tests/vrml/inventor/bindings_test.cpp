#include "tests/vrml/inventor/converted.h"

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

const std::string kPoints = "[ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ]";
const std::string kState = "Coordinate3 { point " + kPoints + " } Material { diffuseColor [ 1 0 0, 0 1 0, 0 0 1 ] } ";
const std::string kFaces = "coordIndex [ 0, 1, 2, -1, 0, 2, 3, -1 ] ";

/// Face set of the state above, with VRML97 fields of its attributes.
std::string faces(const std::string& fields, const std::string& index = "[ 0 1 2 -1 0 2 3 -1 ]") {
  return "Shape { appearance Appearance { material Material { ambientIntensity 0.2 diffuseColor 1 0 0 } } geometry "
         "IndexedFaceSet { creaseAngle 0.5 solid FALSE coord Coordinate { point " +
         kPoints + " } coordIndex " + index + " " + fields + " } }";
}
const std::string kColor = "color Color { color [ 1 0 0, 0 1 0, 0 0 1 ] } ";

void check_material(const std::string& binding, const std::string& index, const std::string& fields) {
  check_converts(
      kVrml1 + kState + "MaterialBinding { value " + binding + " } IndexedFaceSet { " + kFaces + index + " }",
      faces(fields));
}

}  // namespace

TEST_CASE("converts each material binding of an IndexedFaceSet") {
  for (const char* binding : {"DEFAULT", "OVERALL"}) check_material(binding, "materialIndex [ 1, 2 ]", "");
  check_material("PER_FACE", "", kColor + "colorPerVertex FALSE");
  check_material("PER_PART", "", kColor + "colorPerVertex FALSE");
  check_material("PER_FACE_INDEXED", "materialIndex [ 2, 1 ]", kColor + "colorPerVertex FALSE colorIndex [ 2 1 ]");
  check_material("PER_PART_INDEXED", "materialIndex [ 2, 1 ]", kColor + "colorPerVertex FALSE colorIndex [ 2 1 ]");
  check_material("PER_VERTEX_INDEXED", "materialIndex [ 0, 1, 2, -1, 2, 1, 0, -1 ]",
                 kColor + "colorIndex [ 0 1 2 -1 2 1 0 -1 ]");
  // Fewer materials than vertices: they are used in turn.
  check_material("PER_VERTEX", "", kColor + "colorIndex [ 0 1 2 -1 0 1 2 -1 ]");
  check_material("PER_VERTEX_INDEXED", "", kColor + "colorIndex [ 0 1 2 -1 0 2 0 -1 ]");
}

TEST_CASE("keeps the binding if a field is marked as ignored") {
  check_material("PER_VERTEX ~", "", "");
  check_material("PER_FACE } MaterialBinding { value OVERALL ~", "", kColor + "colorPerVertex FALSE");
}

TEST_CASE("converts each normal binding of an IndexedFaceSet") {
  const std::string state = "Coordinate3 { point " + kPoints +
                            " } Material { diffuseColor 1 0 0 } Normal { vector "
                            "[ 0 0 1, 0 1 0, 1 0 0, 0 0 1, 0 1 0, 1 0 0 ] } ";
  const std::string normal = "normal Normal { vector [ 0 0 1, 0 1 0, 1 0 0, 0 0 1, 0 1 0, 1 0 0 ] } ";
  const auto check = [&](const std::string& binding, const std::string& index, const std::string& fields) {
    check_converts(kVrml1 + state + "NormalBinding { value " + binding + " } IndexedFaceSet { " + kFaces + index + " }",
                   faces(normal + fields));
  };
  check("DEFAULT", "", "");
  check("PER_VERTEX_INDEXED", "", "");
  check("PER_VERTEX_INDEXED", "normalIndex [ 0, 1, 2, -1, 3, 4, 5, -1 ]", "normalIndex [ 0 1 2 -1 3 4 5 -1 ]");
  check("PER_VERTEX", "", "normalIndex [ 0 1 2 -1 3 4 5 -1 ]");
  check("PER_FACE", "", "normalPerVertex FALSE");
  check("PER_FACE_INDEXED", "normalIndex [ 5, 4 ]", "normalPerVertex FALSE normalIndex [ 5 4 ]");
  check("OVERALL", "", "normalPerVertex FALSE normalIndex [ 0 0 ]");
  // Normals of another shape.
  const Converted few(kVrml1 + "Coordinate3 { point " + kPoints + " } Normal { vector 0 0 1 } IndexedFaceSet { " +
                      kFaces + "}");
  CHECK(few.says("too few normals"));
}

TEST_CASE("converts ShapeHints, texture coordinates and textures") {
  check_converts(kVrml1 +
                     "ShapeHints { vertexOrdering CLOCKWISE shapeType SOLID faceType UNKNOWN_FACE_TYPE creaseAngle 1 } "
                     "Material { ambientColor 0.2 0 0 diffuseColor 1 0 0 } "
                     "Texture2 { filename \"a.rgb\" wrapS CLAMP } TextureCoordinate2 { point [ 0 0, 1 0, 1 1 ] } "
                     "Coordinate3 { point " +
                     kPoints + " } IndexedFaceSet { coordIndex [ 0, 1, 2 ] textureCoordIndex [ 2, 1, 0 ] }",
                 "Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } texture ImageTexture { "
                 "url \"a.rgb\" repeatS FALSE } } geometry IndexedFaceSet { ccw FALSE convex FALSE creaseAngle 1 coord "
                 "Coordinate { "
                 "point " +
                     kPoints +
                     " } coordIndex [ 0 1 2 ] texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1 ] } "
                     "texCoordIndex [ 2 1 0 ] } }");
  check_converts(
      kVrml1 +
          "Material { ambientColor 0.2 0 0 diffuseColor 1 0 0 } Texture2 { image 1 1 3 0xff8000 } "
          "Texture2Transform { translation 0.5 0 scaleFactor 2 2 } Cube { }",
      "Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } texture PixelTexture { image 1 "
      "1 3 0xff8000 } textureTransform TextureTransform { scale 2 2 translation 0.25 0 } } geometry Box { } }");
}

TEST_CASE("converts shapes of Inventor to IndexedFaceSets") {
  const std::string start = kInventor +
                            "ShapeHints { creaseAngle 0.5 } Material { ambientColor 0.2 0 0 diffuseColor 1 0 "
                            "0 } Coordinate3 { point " +
                            kPoints + " } ";
  check_converts(start + "FaceSet { numVertices [ 3, -1 ] }", faces("", "[ 0 1 2 -1 3 -1 ]"));
  check_converts(start + "TriangleStripSet { numVertices 4 }", faces("", "[ 0 1 2 -1 2 1 3 -1 ]"));
  check_converts(start + "IndexedTriangleStripSet { coordIndex [ 0, 1, 3, 2, -1 ] }",
                 faces("", "[ 0 1 3 -1 3 1 2 -1 ]"));
  check_converts(start + "QuadMesh { verticesPerRow 2 verticesPerColumn 2 }", faces("", "[ 0 2 3 1 -1 ]"));
  check_converts(
      kInventor + "ShapeHints { creaseAngle 0.5 } FaceSet { vertexProperty VertexProperty { vertex " + kPoints +
          " orderedRGBA [ 0xff0000ff, 0x00ff00ff ] materialBinding PER_FACE } numVertices [ 3, 1 ] }",
      "Shape { appearance Appearance { material Material { ambientIntensity 0.2 diffuseColor 1 0 0 } } geometry "
      "IndexedFaceSet { creaseAngle 0.5 solid FALSE coord Coordinate { point " +
          kPoints +
          " } coordIndex "
          "[ 0 1 2 -1 3 -1 ] color Color { color [ 1 0 0, 0 1 0 ] } colorPerVertex FALSE } }");
}

TEST_CASE("draws lines and points without lighting, in the diffuse colour") {
  const std::string red =
      "appearance Appearance { material Material { ambientIntensity 0 diffuseColor 0 0 0 emissiveColor "
      "1 0 0 } } ";
  const std::string coord = "coord Coordinate { point " + kPoints + " } ";
  const std::string start = kVrml1 + "Coordinate3 { point " + kPoints + " } Material { diffuseColor 1 0 0 } ";
  check_converts(start + "IndexedLineSet { coordIndex [ 0, 1, 2, -1 ] }",
                 "Shape { " + red + "geometry IndexedLineSet { " + coord + "coordIndex [ 0 1 2 -1 ] } }");
  check_converts(start + "PointSet { }", "Shape { " + red + "geometry PointSet { " + coord + "} }");
  check_converts(start + "PointSet { startIndex 1 numPoints 1 }",
                 "Shape { " + red + "geometry PointSet { coord Coordinate { point 1 0 0 } } }");
  check_converts(start + "LineSet { numVertices 2 }",
                 "Shape { " + red + "geometry IndexedLineSet { " + coord + "coordIndex [ 0 1 -1 ] } }");
  check_converts(start + "DrawStyle { style LINES } IndexedFaceSet { coordIndex [ 0, 1, 2, -1 ] }",
                 "Shape { " + red + "geometry IndexedLineSet { " + coord + "coordIndex [ 0 1 2 0 -1 ] } }");
  check_converts(start + "DrawStyle { style INVISIBLE } IndexedFaceSet { coordIndex [ 0, 1, 2, -1 ] } Cube { }", "");
  // Colours of segments.
  check_converts(
      kVrml1 + kState + "MaterialBinding { value PER_PART } IndexedLineSet { coordIndex [ 0, 1, 2, -1, 3, 0 ] }",
      "Shape { geometry IndexedLineSet { " + coord + "coordIndex [ 0 1 -1 1 2 -1 3 0 -1 ] " + kColor +
          "colorPerVertex FALSE colorIndex [ 0 1 2 ] } }");
}

TEST_CASE("draws shapes with LightModel BASE_COLOR and precomputed colours without lighting") {
  check_converts(
      kInventor + "LightModel { model BASE_COLOR } BaseColor { rgb 0 1 0 } Cube { }",
      "Shape { appearance Appearance { material Material { ambientIntensity 0 diffuseColor 0 0 0 emissiveColor 0 "
      "1 0 } } geometry Box { } }");
  check_converts(
      kVrml1 + "Material { diffuseColor [ ] emissiveColor 0 1 0 } Cube { }",
      "Shape { appearance Appearance { material Material { ambientIntensity 0 diffuseColor 0 0 0 emissiveColor 0 "
      "1 0 } } geometry Box { } }");
}

TEST_CASE("converts parts of solids with their materials") {
  check_converts(
      kVrml1 +
          "Material { ambientColor 0.2 0 0 diffuseColor [ 1 0 0, 0 1 0 ] } MaterialBinding { value PER_PART } Cone { }",
      "Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } } geometry Cone { bottom FALSE } } "
      "Shape { appearance Appearance { material Material { ambientIntensity 0 diffuseColor 0 1 0 } } geometry "
      "Cone { side FALSE } }");
  const Converted open(kVrml1 + "Cylinder { parts (SIDES | TOP) }");
  CHECK(print(open.scene).find("solid FALSE") != std::string::npos);
}
