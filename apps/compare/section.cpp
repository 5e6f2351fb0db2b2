// SPDX-License-Identifier: BSD-3-Clause
#include "compare/section.h"

#include <tuple>
#include <utility>

#include "compare/section_svg.h"
#include "pcl_slim/compare/sections.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {
namespace {

constexpr const char* kColorOfA = "#c0281e";
constexpr const char* kColorOfB = "#1f4fb4";

/** The triangles of an object: those of its carrier, where it was covered already. */
Result<TriangleMesh> trianglesOf(const ComparedInput& object, const Comparison& comparison,
                                 const ComparisonJob& job, Progress& progress) {
  if (&comparison.measuredObject() == &object) return comparison.carrier().mesh;
  if (object.isMesh()) return object.mesh;
  Result<CarrierMesh> carrier = object.carrier(job.carrier, progress);
  if (!carrier) return carrier.error();
  return std::move(carrier->mesh);
}

Result<SectionOutline> outlineOf(const ComparedInput& object, const TriangleMesh& mesh,
                                 const SectionPlane& plane, const char* color) {
  const auto lines = cutMesh(mesh, plane);
  if (!lines) return lines.error();
  SectionOutline outline;
  outline.name = object.name();
  outline.color = color;
  for (const SectionLine& line : *lines) {
    auto& flat = outline.lines.emplace_back();
    for (const Vector3& p : line.points) flat.push_back(plane.flat(p));
    if (line.closed) flat.push_back(flat.front());
  }
  return outline;
}

}  // namespace

void SectionRequest::declare(OptionTable& table) {
  table.numbers("section", &plane, "X,Y,Z,NX,NY,NZ",
                "cut both by a plane through X,Y,Z with this normal");
  table.text("section_file", &file, "FILE.svg", "the outlines of both in that plane",
             FileUse::kWritten);
}

Error SectionRequest::parse() const {
  if (plane.empty() != file.empty())
    return {ErrorCode::kBadArgument, "-section and -section_file go together: give both"};
  if (plane.empty()) return {};
  if (lowerExtension(file) != ".svg")
    return {ErrorCode::kBadArgument,
            "cannot write a section named '" + file + "'; name a .svg file"};
  return SectionPlane::through({plane[0], plane[1], plane[2]}, {plane[3], plane[4], plane[5]})
      .error();
}

Error writeSection(const SectionRequest& request, const Comparison& comparison,
                   const ComparisonJob& job, const std::string& unit, const ComparedInput& a,
                   const ComparedInput& b, Console& console, Report& report) {
  if (request.plane.empty()) return {};
  const std::vector<double>& p = request.plane;
  const Result<SectionPlane> plane = SectionPlane::through({p[0], p[1], p[2]}, {p[3], p[4], p[5]});
  if (!plane) return plane.error();
  console.begin("Cutting");
  Result<TriangleMesh> of_a = trianglesOf(a, comparison, job, console.progress());
  if (!of_a) return console.failed(of_a.error());
  for (Vector3& v : of_a->vertices) v = comparison.motion().place(v);
  const Result<TriangleMesh> of_b = trianglesOf(b, comparison, job, console.progress());
  if (!of_b) return console.failed(of_b.error());
  std::vector<SectionOutline> outlines;
  for (const auto& [object, mesh, color] :
       {std::tuple(&b, &*of_b, kColorOfB), std::tuple(&a, &std::as_const(*of_a), kColorOfA)}) {
    Result<SectionOutline> outline = outlineOf(*object, *mesh, *plane, color);
    if (!outline) return console.failed(outline.error());
    outlines.push_back(std::move(*outline));
  }
  const std::size_t lines = outlines[0].lines.size() + outlines[1].lines.size();
  if (lines == 0) {
    return console.failed(
        {ErrorCode::kBadArgument, "the plane of -section meets neither; move it"});
  }
  const std::string title = "Section through " + numberText(p[0]) + ", " + numberText(p[1]) + ", " +
                            numberText(p[2]) + " across " + numberText(plane->normal[0], 3) + ", " +
                            numberText(plane->normal[1], 3) + ", " +
                            numberText(plane->normal[2], 3);
  const std::string svg = sectionSvg(outlines, title, unit);
  if (Error error = writeFile(request.file, svg.data(), svg.size())) return console.failed(error);
  report.time("section", console.seconds());
  report.set("section_lines", lines);
  console.done(counted(lines, "line"));
  return {};
}

}  // namespace pcl_slim
