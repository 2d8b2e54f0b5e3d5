#include "src/results/comparison.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/results/percentile.h"

namespace dea {

namespace {

bool in(const FacetMask& mask, int facet) { return mask.empty() || mask[at(facet)]; }

/// The vertices of a facet, each once: a collapsed quad names one twice. Into `vertices`, whatever was there.
void distinct_vertices(const ResultSurface& s, int facet, std::vector<int>& vertices) {
  vertices.clear();
  for (int k = s.begin[at(facet)]; k < s.begin[at(facet) + 1]; ++k) {
    const int v = s.slot_vertex[at(k)];
    if (v >= 0 && std::find(vertices.begin(), vertices.end(), v) == vertices.end()) vertices.push_back(v);
  }
}

bool same_facets(const ResultSurface& a, const ResultSurface& b) {
  if (a.begin != b.begin || a.slot_position.size() != b.slot_position.size()) return false;
  double extent = 0.0;
  for (const Vector3d& x : a.slot_position) extent = std::max(extent, (x - a.slot_position.front()).norm());
  // plot files hold positions in single precision, and programs round a text's digits differently
  for (std::size_t i = 0; i < a.slot_position.size(); ++i)
    if ((a.slot_position[i] - b.slot_position[i]).norm() > 1e-5 * extent ||
        (a.slot_vertex[i] < 0) != (b.slot_vertex[i] < 0))
      return false;
  return true;
}

double facet_size(const ResultSurface& s) {
  const double area = std::accumulate(s.facet_areas.begin(), s.facet_areas.end(), 0.0);
  return s.facets() > 0 ? std::sqrt(area / s.facets()) : 0.0;
}

/// Sets `around`.
void find_facets_around(ResultSurface& s) {
  std::vector<std::vector<int>> around(s.mesh.vertices.size());
  std::vector<int> vertices;
  for (int f = 0; f < s.facets(); ++f) {
    distinct_vertices(s, f, vertices);
    for (int v : vertices) around[at(v)].push_back(f);
  }
  s.around_begin = {0};
  for (const std::vector<int>& facets : around) {
    s.around.insert(s.around.end(), facets.begin(), facets.end());
    s.around_begin.push_back(static_cast<int>(s.around.size()));
  }
}

/// Integral over an interval of max(0, e) where e goes linearly from a to b.
double positive_part(double a, double b, double dt) {
  if (a >= 0 && b >= 0) return 0.5 * (a + b) * dt;
  if (a <= 0 && b <= 0) return 0.0;
  const double positive = std::max(a, b);
  return 0.5 * positive * positive / std::abs(b - a) * dt;
}

}  // namespace

ResultSurface make_result_surface(const std::string& name, const std::vector<int>& begin, const std::vector<int>& nodes,
                                  const std::vector<Vector3d>& positions) {
  ResultSurface s;
  s.name = name;
  s.begin = begin;
  s.mesh = make_surface_mesh(begin, nodes, positions);
  std::unordered_map<int, int> vertex;
  for (std::size_t v = 0; v < s.mesh.model_nodes.size(); ++v) vertex[s.mesh.model_nodes[v]] = static_cast<int>(v);
  for (int node : nodes) {
    const auto found = vertex.find(node);
    s.slot_vertex.push_back(found == vertex.end() ? -1 : found->second);
    s.slot_position.push_back(positions[at(node)]);
  }
  s.facet_areas.assign(at(s.facets()), 0.0);
  s.area_vectors.assign(at(s.facets()), Vector3d::Zero());
  s.facet_centers.assign(at(s.facets()), Vector3d::Zero());
  for (int t = 0; t < s.mesh.size(); ++t) {
    const std::size_t f = at(s.mesh.facet[at(t)]);
    s.facet_areas[f] += s.mesh.areas[at(t)];
    s.area_vectors[f] += s.mesh.areas[at(t)] * s.mesh.normals[at(t)];
    s.facet_centers[f] += s.mesh.areas[at(t)] * s.mesh.centroid(t);
  }
  for (std::size_t f = 0; f < s.facet_areas.size(); ++f)
    if (s.facet_areas[f] > 0) s.facet_centers[f] /= s.facet_areas[f];
  find_facets_around(s);
  return s;
}

ResultSurface with_areas_of(ResultSurface surface, const ResultSurface& moved) {
  assert(surface.begin == moved.begin);
  surface.facet_areas = moved.facet_areas;
  surface.area_vectors = moved.area_vectors;
  return surface;
}

std::vector<double> nodal_average(const ResultSurface& s, const std::vector<double>& facet_values) {
  std::vector<double> sum(s.mesh.vertices.size(), 0.0), area(s.mesh.vertices.size(), 0.0);
  std::vector<int> vertices;
  for (int f = 0; f < s.facets(); ++f) {
    distinct_vertices(s, f, vertices);
    for (int v : vertices) {
      sum[at(v)] += s.facet_areas[at(f)] * facet_values[at(f)];
      area[at(v)] += s.facet_areas[at(f)];
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = area[v] > 0 ? sum[v] / area[v] : 0.0;
  return sum;
}

std::vector<double> nodal_areas(const ResultSurface& s, const FacetMask& mask) {
  std::vector<double> areas(s.mesh.vertices.size(), 0.0);
  std::vector<int> vertices;
  for (int f = 0; f < s.facets(); ++f) {
    if (!in(mask, f)) continue;
    distinct_vertices(s, f, vertices);
    for (int v : vertices) areas[at(v)] += s.facet_areas[at(f)] / static_cast<double>(vertices.size());
  }
  return areas;
}

std::vector<double> facet_areas(const ResultSurface& s, const FacetMask& mask) {
  std::vector<double> areas = s.facet_areas;
  for (int f = 0; f < s.facets(); ++f)
    if (!in(mask, f)) areas[at(f)] = 0.0;
  return areas;
}

std::vector<double> facet_average(const SurfaceMesh& mesh, const std::vector<double>& areas,
                                  const std::vector<double>& vertex_values) {
  std::vector<double> out(areas.size(), 0.0);
  for (int t = 0; t < mesh.size(); ++t) {
    double mean = 0.0;
    for (int v : mesh.triangles[at(t)]) mean += vertex_values[at(v)] / 3.0;
    out[at(mesh.facet[at(t)])] += mesh.areas[at(t)] * mean;
  }
  for (std::size_t f = 0; f < out.size(); ++f) out[f] = areas[f] > 0 ? out[f] / areas[f] : 0.0;
  return out;
}

Distribution distribution(const std::vector<double>& values, const std::vector<double>& areas, double threshold) {
  std::vector<double> v, w;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] > threshold && areas[i] > 0)) continue;
    v.push_back(values[i]);
    w.push_back(areas[i]);
  }
  Distribution d;
  if (v.empty()) {
    d.peak = d.p99 = d.mean = d.p5 = d.p25 = d.median = d.p75 = d.p95 = d.p99_unweighted = kNaN;
    return d;
  }
  d.area = std::accumulate(w.begin(), w.end(), 0.0);
  d.mean = std::inner_product(w.begin(), w.end(), v.begin(), 0.0) / d.area;
  d.peak = *std::max_element(v.begin(), v.end());
  const WeightedValues sorted = in_rising_order(v, w);
  set_percentiles(d, sorted);
  d.p99_unweighted = percentile_of_sorted(sorted.values, 0.99);
  return d;
}

SurfaceMeasures measure(const ResultSurface& s, const SurfaceValues& values, const std::vector<double>& thresholds,
                        const FacetMask& mask) {
  SurfaceMeasures m;
  const std::vector<double> nodal = nodal_average(s, values.pressure), on_nodes = nodal_areas(s, mask),
                            on_facets = facet_areas(s, mask);
  for (double threshold : thresholds) {
    m.facets.push_back(distribution(values.pressure, on_facets, threshold));
    m.nodes.push_back(distribution(nodal, on_nodes, threshold));
  }
  double force = 0.0, area = 0.0, gap = 0.0;
  Vector3d moment = Vector3d::Zero();
  m.mean_penetration = m.max_penetration = kNaN;
  for (std::size_t f = 0; f < on_facets.size(); ++f) {
    const double p = values.pressure[f], a = on_facets[f];
    if (!(p > 0 && a > 0)) continue;
    force += p * a;
    area += a;
    moment += p * a * s.facet_centers[f];
    m.resultant += p * s.area_vectors[f];
    if (values.gap.empty()) continue;
    gap += a * values.gap[f];
    if (!(m.max_penetration >= values.gap[f])) m.max_penetration = values.gap[f];
  }
  if (!values.gap.empty() && area > 0) m.mean_penetration = gap / area;
  m.center_of_pressure = force > 0 ? Vector3d(moment / force) : Vector3d::Constant(kNaN);
  return m;
}

InterfaceCompliance interface_compliance(const std::vector<double>& pressure, const std::vector<double>& gap,
                                         const std::vector<double>& areas) {
  InterfaceCompliance c{kNaN, kNaN, kNaN, 0};
  if (gap.empty() || pressure.empty()) return c;
  const double least = 0.1 * *std::max_element(pressure.begin(), pressure.end());
  std::vector<double> ratios, forces;
  double force = 0.0, yielding = 0.0;
  for (std::size_t f = 0; f < pressure.size(); ++f) {
    if (!(pressure[f] > 0 && pressure[f] >= least && areas[f] > 0)) continue;
    ratios.push_back(gap[f] / pressure[f]);
    forces.push_back(areas[f] * pressure[f]);
    force += forces.back();
    yielding += areas[f] * gap[f];
  }
  if (ratios.empty()) return c;
  c.compliance = yielding / force;
  const WeightedValues sorted = in_rising_order(ratios, forces);
  c.p5 = percentile(sorted, 0.05);
  c.p95 = percentile(sorted, 0.95);
  c.facets = static_cast<int>(ratios.size());
  return c;
}

NodeMatch match_nodes(const ResultSurface& onto, const ResultSurface& from) {
  NodeMatch match;
  match.same_mesh = same_facets(onto, from);
  if (match.same_mesh) {
    match.vertices.assign(onto.mesh.vertices.size(), -1);
    for (std::size_t k = 0; k < onto.slot_vertex.size(); ++k)
      if (onto.slot_vertex[k] >= 0) match.vertices[at(onto.slot_vertex[k])] = from.slot_vertex[k];
    return match;
  }
  match.points.resize(onto.mesh.vertices.size());
  match.covered = 0.0;
  if (from.mesh.size() == 0) return match;
  const RayCaster caster(from.mesh);
  const double reach = std::max(facet_size(onto), facet_size(from));
  const std::vector<double> areas = nodal_areas(onto);
  double covered = 0.0, total = 0.0;
  for (std::size_t v = 0; v < match.points.size(); ++v) {
    const SurfacePoint point = caster.closest(onto.mesh.vertices[v]);
    total += areas[v];
    if (point.triangle < 0) continue;  // beyond single precision
    if ((position(from.mesh, point) - onto.mesh.vertices[v]).norm() > reach) continue;
    match.points[v] = point;
    covered += areas[v];
  }
  match.covered = total > 0 ? covered / total : 0.0;
  return match;
}

std::vector<double> carry_values(const NodeMatch& match, const ResultSurface& from,
                                 const std::vector<double>& vertex_values) {
  std::vector<double> out;
  if (match.same_mesh) {
    for (int v : match.vertices) out.push_back(vertex_values[at(v)]);
    return out;
  }
  for (const SurfacePoint& point : match.points)
    out.push_back(point.triangle < 0 ? kNaN : interpolate(from.mesh, vertex_values, point));
  return out;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b, const std::vector<double>& weights) {
  double total = 0.0, mean_a = 0.0, mean_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    total += weights[i];
    mean_a += weights[i] * a[i];
    mean_b += weights[i] * b[i];
  }
  if (!(total > 0)) return kNaN;
  mean_a /= total;
  mean_b /= total;
  double aa = 0.0, bb = 0.0, ab = 0.0, size_a = 0.0, size_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += weights[i] * (a[i] - mean_a) * (a[i] - mean_a);
    bb += weights[i] * (b[i] - mean_b) * (b[i] - mean_b);
    ab += weights[i] * (a[i] - mean_a) * (b[i] - mean_b);
    size_a += weights[i] * a[i] * a[i];
    size_b += weights[i] * b[i] * b[i];
  }
  // what is left of a constant is its rounding, and has no pattern
  if (aa <= 1e-24 * size_a || bb <= 1e-24 * size_b) return kNaN;
  return std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0);
}

PatternDifference pattern_difference(const std::vector<double>& a, const std::vector<double>& b,
                                     const std::vector<double>& areas, const std::vector<double>& thresholds) {
  PatternDifference d;
  std::vector<double> pa, pb, w;
  double total = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) || !(areas[i] > 0) || !(a[i] > 0 || b[i] > 0)) continue;
    pa.push_back(a[i]);
    pb.push_back(b[i]);
    w.push_back(areas[i]);
    const double difference = a[i] - b[i];
    total += areas[i];
    sum += areas[i] * difference;
    squares += areas[i] * difference * difference;
    if (std::abs(difference) > std::abs(d.largest)) d.largest = difference;
  }
  d.correlation = correlation(pa, pb, w);
  d.rms = total > 0 ? std::sqrt(squares / total) : kNaN;
  d.mean = total > 0 ? sum / total : kNaN;
  if (!(total > 0)) d.largest = kNaN;
  for (double threshold : thresholds) {
    double both = 0.0, of_a = 0.0, of_b = 0.0;
    for (std::size_t i = 0; i < w.size(); ++i) {
      if (pa[i] > threshold) of_a += w[i];
      if (pb[i] > threshold) of_b += w[i];
      if (pa[i] > threshold && pb[i] > threshold) both += w[i];
    }
    d.dice.push_back(of_a + of_b > 0 ? 2 * both / (of_a + of_b) : kNaN);
  }
  return d;
}

double percent_difference(double a, double b) {
  if (a == b) return 0.0;
  return b != 0 ? 100.0 * (a - b) / std::abs(b) : kNaN;
}

SurfaceFrame surface_frame(const ResultSurface& s) {
  SurfaceFrame frame;
  double area = 0.0;
  for (const Vector3d& a : s.area_vectors) {
    frame.axis += a;
    area += a.norm();
  }
  if (frame.axis.norm() > 1e-9 * area)
    frame.axis.normalize();
  else
    frame.axis.setZero();  // a closed surface has no axis: what is left of the sum is rounding
  const SurfaceExtent extent = surface_extent(s.mesh);
  const SphereFit sphere = fit_sphere(s.mesh);
  frame.center = sphere.radius > 0 && sphere.radius < 10 * extent.radius_of_gyration ? sphere.center : extent.centroid;
  return frame;
}

std::vector<int> third_of(const std::vector<Vector3d>& points, const SurfaceFrame& frame, const Vector3d& up,
                          const Vector3d& anterior) {
  Vector3d top = up - up.dot(frame.axis) * frame.axis, front = anterior - anterior.dot(frame.axis) * frame.axis;
  const double top_length = top.norm();
  if (!(top_length > 1e-6 * up.norm()))
    throw UsageError("up points along the surface's axis: it has no top, front or back");
  top /= top_length;
  front -= front.dot(top) * top;
  if (!(front.norm() > 1e-6 * anterior.norm()))
    throw UsageError("up and anterior span no plane across the surface's axis");
  front.normalize();
  std::vector<double> angle;
  for (const Vector3d& x : points)
    angle.push_back(std::atan2((x - frame.center).dot(front), (x - frame.center).dot(top)));
  std::vector<int> order(angle.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return angle[at(a)] > angle[at(b)]; });
  std::vector<int> third(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) third[at(order[i])] = static_cast<int>(3 * i / order.size());
  return third;
}

std::vector<ProfileBin> pressure_profile(const ResultSurface& s, const std::vector<double>& facet_pressure,
                                         const Vector3d& axis, const Vector3d& center, double bin_degrees) {
  std::vector<ProfileBin> bins;
  std::vector<double> force;
  for (std::size_t f = 0; f < s.facet_areas.size(); ++f) {
    if (!(s.facet_areas[f] > 0)) continue;
    const Vector3d d = s.facet_centers[f] - center;
    const double angle = kDegreesPerRadian * std::atan2(axis.cross(d).norm(), axis.dot(d));
    const std::size_t bin = static_cast<std::size_t>(angle / bin_degrees);
    while (bins.size() <= bin) {
      const double from = bin_degrees * static_cast<double>(bins.size());
      bins.push_back({from, from + bin_degrees, 0.0, kNaN});
      force.push_back(0.0);
    }
    bins[bin].area += s.facet_areas[f];
    force[bin] += s.facet_areas[f] * facet_pressure[f];
  }
  for (std::size_t b = 0; b < bins.size(); ++b)
    if (bins[b].area > 0) bins[b].mean = force[b] / bins[b].area;
  return bins;
}

TimeSums over_time(const std::vector<double>& times, const std::vector<std::vector<double>>& values,
                   std::optional<double> dose_above) {
  TimeSums sums;
  if (values.empty()) return sums;
  sums.peak = values.front();
  sums.exposure.assign(sums.peak.size(), 0.0);
  if (dose_above) sums.dose = sums.exposure;
  for (std::size_t s = 1; s < values.size(); ++s) {
    const double dt = times[s] - times[s - 1];
    for (std::size_t i = 0; i < sums.peak.size(); ++i) {
      const double a = values[s - 1][i], b = values[s][i];
      sums.peak[i] = std::max(sums.peak[i], b);
      sums.exposure[i] += 0.5 * (a + b) * dt;
      if (dose_above) sums.dose[i] += positive_part(a - *dose_above, b - *dose_above, dt);
    }
  }
  return sums;
}

PoseDifference pose_difference(const BodyPose& a, const BodyPose& b) {
  PoseDifference d;
  d.translation = a.position - b.position;
  if (a.rotation && b.rotation) {
    const Eigen::AngleAxisd turn(a.rotation->normalized() * b.rotation->normalized().conjugate());
    d.rotation = turn.angle() * turn.axis();
  }
  return d;
}

}  // namespace dea
