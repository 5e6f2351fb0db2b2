#include "ours.h"
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include "measure/clocks.h"
#include "pcl_slim/mesh/mesh_smoothing.h"
namespace pcl_slim::mesh_bench {
void
ours(const Pair& pair, const std::string& options,
     const std::function<void(const std::string&, const std::string&, const Measures&, double)>&
         print)
{
  std::istringstream in(options);
  std::string kv;
  bool paper = false;
  Pair p2 = pair;
  std::string modes = "012";
  while (in >> kv) {
    auto e = kv.find('=');
    if (kv.substr(0, e) == "paper")
      paper = true;
    else if (kv.substr(0, e) == "clean")
      p2.noisy = p2.truth;
    else if (kv.substr(0, e) == "modes")
      modes = kv.substr(e + 1);
    else
      setenv(kv.substr(0, e).c_str(), kv.c_str() + e + 1, 1);
  }
  for (char m : modes) {
    MeshSmoothParams params;
    params.edges = static_cast<MeshEdges>(m - '0');
    params.fit.threads = 1;
    params.fit.paper_mode = paper;
    CloudView w;
    w.xyz = p2.noisy.data();
    w.xyz_stride = 24;
    w.scalar = CloudView::Scalar::kDouble;
    w.size = p2.noisy.size();
    SmoothedMesh made;
    MeshSmoothStatistics st;
    const double t0 = measure::cpuSeconds();
    Error e = smoothMesh(w, pair.faces, params, nullptr, made, &st);
    const double t = measure::cpuSeconds() - t0;
    if (e) std::printf("%s\n", e.message.c_str());
    double ang = 0;
    Points truth = faceNormals(pair.truth, pair.faces);
    for (std::size_t f = 0; f < truth.size(); ++f)
      ang += std::acos(std::max(-1., std::min(1., dot(truth[f], made.face_normals[f])))) * 57.3 /
             static_cast<double>(truth.size());
    char b[300];
    std::snprintf(b, 300, "mode %c sharp %d share %.3f noise %.3f held %lu normals %.2f", m,
                  st.sharp, st.sharp_share, st.noise, (unsigned long)st.held, ang);
    print(pair.name, b, compare(p2, made.vertices), t);
  }
}
}  // namespace pcl_slim::mesh_bench
