// Contact of deformable tooth flanks by face quadrature, and block assembly of contact terms.
//
// The master flank is the exact tooth profile plus the finite-element displacement: between two
// profile nodes the curve is the cubic Hermite interpolant of their exact points and tangents and a
// polynomial that the exact profile has above it, without a value and a slope at both, so that its
// normal is continuous; the displacement is bilinear over the facet. The curve's height
// over its chord rotates with the body, so that a body rotated as a whole has the rotated flank. A
// point of the slave surface is projected onto it orthogonally; the gap's first and second
// variations are exact for that surface at that rotation.
//
// Words: the foot point is the projection of a slave point onto the master flank; the gap is its
// distance along the outward normal there, negative in penetration. Lengths in mm, forces in N,
// pressures in MPa, penalties in MPa / mm.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <vector>

#include "images.hpp"

namespace swgpar {

// Limits of the projection onto a flank; eta and zeta are counted in facets.
// A foot point belongs to the facet in which it lies. Where the flank has a convex edge between two
// facets it may lie in neither: after some changes from one to the other a facet's parameters may
// exceed it a little.
constexpr double kBorder = 1e-9;
constexpr double kOverlap = 0.02;
constexpr int kMostChanges = 6;
constexpr double kLastStep =
    1e-10;  // of Newton's iteration: round-off of positions far from the axis allows 1e-13
constexpr double kLongestStep =
    1.0;  // of Newton's iteration: one facet, after which the next facet is taken
constexpr int kMostSteps = 40;  // some 5 within a facet, the rest walk over the flank
constexpr double kConvex =
    0.2;  // smallest share of the metric that the Hessian of the squared distance may
          // have: below it the metric stands in (Gauss-Newton), which always descends
constexpr double kGivenUp =
    1.0;  // facets past the end of the grid beyond which there is no foot point

// Rows of the blocked matrix that this rank owns, of a symmetric one the upper triangle; blocks are
// column-major.
struct BlockRows {
  const std::int64_t* start;   // (n_own + 1)
  const std::int32_t* column;  // global block columns, ascending in a row
  double* values;              // (n_blocks, 9)
  const std::int32_t* number;  // (n_local) global number of a local node
  std::int64_t n_own;
  bool symmetric;

  // Adds a block; false when the pattern lacks it.
  bool add(std::int32_t row, std::uint8_t row_flip, std::int32_t col, std::uint8_t col_flip,
           const Mat3& block) const {
    if (row < 0 || col < 0 || row >= n_own) return true;
    const std::int32_t wanted = number[col];
    if (symmetric && wanted < number[row]) return true;
    std::int64_t lo = start[row], hi = start[row + 1];
    while (lo < hi) {
      const std::int64_t mid = (lo + hi) / 2;
      if (column[mid] < wanted)
        lo = mid + 1;
      else
        hi = mid;
    }
    if (lo == start[row + 1] || column[lo] != wanted) return false;
    Eigen::Map<Mat3>(values + 9 * lo) += of_owners(block, row_flip, col_flip);
    return true;
  }
};

// One flank of the master body: a grid of (n_s + 1) x (n_z + 1) nodes.
struct Patch {
  int n_s, n_z;
  const double* s;                  // (n_s + 1) arc length
  const double* z;                  // (n_z + 1)
  const double* point;              // (n_s + 1, 2) exact profile, sector frame
  const double* tangent;            // (n_s + 1, 2) unit
  const double* bulge;              // (n_s, 4, 2) see `bulge_at`
  double orientation;               // sign that makes x_s cross x_z point out of the material
  double tooth_cosine, tooth_sine;  // of the angle of the tooth
  double body_cosine, body_sine;    // of the rotation of the body as a whole
  const std::int32_t* conn;         // (n_s + 1, n_z + 1)
  const std::uint8_t* sixths;

  std::int32_t node(int i, int j) const { return conn[i * (n_z + 1) + j]; }
  std::uint8_t image(int i, int j) const { return sixths[i * (n_z + 1) + j]; }
  // Vector of the sector's frame in that of the undeformed drive.
  Vec2 placed(const double* p) const {
    return Vec2(tooth_cosine * p[0] - tooth_sine * p[1], tooth_sine * p[0] + tooth_cosine * p[1]);
  }
  // Vector of the undeformed drive, rotated with the body.
  Vec2 rotated(const Vec2& v) const {
    return Vec2(body_cosine * v[0] - body_sine * v[1], body_sine * v[0] + body_cosine * v[1]);
  }
  // What the exact profile has above the cubic between the profile nodes i and i + 1, and its
  // derivatives by eta: t^2 (1 - t)^2 times a cubic in t - 1/2, without a value and a slope at both
  // ends.
  void bulge_at(int i, double t, Vec2 (&out)[4]) const {
    const double* c = bulge + 8 * i;
    const double x = t - 0.5, r = t * (1 - t);
    const double w[4] = {r * r, 2 * r * (1 - 2 * t), 2 - 12 * t + 12 * t * t, 24 * t - 12};
    Vec2 q[4];
    for (int k = 0; k < 2; ++k) {
      q[0][k] = c[k] + x * (c[2 + k] + x * (c[4 + k] + x * c[6 + k]));
      q[1][k] = c[2 + k] + x * (2 * c[4 + k] + x * 3 * c[6 + k]);
      q[2][k] = 2 * c[4 + k] + 6 * x * c[6 + k];
      q[3][k] = 6 * c[6 + k];
    }
    out[0] = w[0] * q[0];
    out[1] = w[1] * q[0] + w[0] * q[1];
    out[2] = w[2] * q[0] + 2 * w[1] * q[1] + w[0] * q[2];
    out[3] = w[3] * q[0] + 3 * w[2] * q[1] + 3 * w[1] * q[2] + w[0] * q[3];
    for (Vec2& one : out) one = placed(one.data());
  }
  // Third derivative by eta of the curve between the profile nodes i and i + 1.
  Vec3 third_derivative(int i, double t) const {
    const double len = s[i + 1] - s[i];
    const Vec2 d = 12 * (placed(point + 2 * i) - placed(point + 2 * i + 2)) +
                   6 * len * (placed(tangent + 2 * i) + placed(tangent + 2 * i + 2));
    Vec2 more[4];
    bulge_at(i, t, more);
    const Vec2 now = rotated(d + more[3]);
    return Vec3(now[0], now[1], 0);
  }
};

// Foot point on a patch and what the variations of the gap need there: the position x (mm) and its
// derivatives by the facet's coordinates eta (along the profile) and zeta (along the width), 0 .. 1
// on the facet.
struct FootPoint {
  int i = 0, j = 0;  // facet
  double eta = 0.5, zeta = 0.5, gap = 0.0;
  Vec3 x, x_eta, x_zeta, x_etaeta, x_etazeta, normal;
  Vec2 height, height_eta;               // of the curve over its chord, and its derivative
  bool found = false, straight = false;  // straight: past the ends of the profile
};

// Position and derivatives at the coordinates of f; u : (n_local, 3) displacements.
inline void evaluate(const Patch& p, const double* u, FootPoint& f) {
  const int i = f.i, j = f.j;
  // past the ends of the profile the curve goes on straight
  const double past = i == 0 && f.eta < 0 ? f.eta : i == p.n_s - 1 && f.eta > 1 ? f.eta - 1 : 0.0;
  f.straight = past != 0.0;
  const double t = f.eta - past, t2 = t * t, t3 = t2 * t, len = p.s[i + 1] - p.s[i];
  const Vec2 a = p.placed(p.point + 2 * i), b = p.placed(p.point + 2 * i + 2);
  const Vec2 ta = len * p.placed(p.tangent + 2 * i), tb = len * p.placed(p.tangent + 2 * i + 2);
  const Vec2 chord = b - a;
  Vec2 more[4];
  p.bulge_at(i, t, more);
  f.height_eta = p.rotated((6 * t - 6 * t2 - 1) * chord + (3 * t2 - 4 * t + 1) * ta +
                           (3 * t2 - 2 * t) * tb + more[1]);
  f.height =
      p.rotated((3 * t2 - 2 * t3 - t) * chord + (t3 - 2 * t2 + t) * ta + (t3 - t2) * tb + more[0]) +
      past * f.height_eta;
  const Vec2 x = a + f.eta * chord + f.height;
  const Vec2 d = chord + f.height_eta;
  Vec2 dd = Vec2::Zero();
  if (!f.straight)
    dd = p.rotated((6 - 12 * t) * chord + (6 * t - 4) * ta + (6 * t - 2) * tb + more[2]);
  const double z0 = p.z[j], dz = p.z[j + 1] - z0, e = f.eta, q = f.zeta;
  const Vec3 u00 = nodal(u, p.node(i, j), p.image(i, j)),
             u10 = nodal(u, p.node(i + 1, j), p.image(i + 1, j));
  const Vec3 u01 = nodal(u, p.node(i, j + 1), p.image(i, j + 1));
  const Vec3 u11 = nodal(u, p.node(i + 1, j + 1), p.image(i + 1, j + 1));
  f.x = Vec3(x[0], x[1], z0 + q * dz) + (1 - e) * (1 - q) * u00 + e * (1 - q) * u10 +
        (1 - e) * q * u01 + e * q * u11;
  f.x_eta = Vec3(d[0], d[1], 0) + (1 - q) * (u10 - u00) + q * (u11 - u01);
  f.x_zeta = Vec3(0, 0, dz) + (1 - e) * (u01 - u00) + e * (u11 - u10);
  f.x_etaeta = Vec3(dd[0], dd[1], 0);
  f.x_etazeta = u00 - u10 - u01 + u11;
}

// Foot point from which the projection of a point starts: next to the nearest profile node.
inline FootPoint nearest_node(const Patch& p, const double* u, const Vec3& xs) {
  FootPoint f;
  int j = 0;
  while (j < p.n_z - 1 && p.z[j + 1] < xs[2]) ++j;
  double best = 1e300;
  int row = 0;
  for (int i = 0; i <= p.n_s; ++i) {
    const Vec2 x = p.placed(p.point + 2 * i);
    const Vec3 d = nodal(u, p.node(i, j), p.image(i, j));
    const double dist = (Vec2(xs[0], xs[1]) - x - d.head<2>()).squaredNorm();
    if (dist < best) best = dist, row = i;
  }
  f.i = std::min(row, p.n_s - 1);
  f.eta = row == f.i ? 0.0 : 1.0;
  f.j = j;
  f.zeta = (xs[2] - p.z[j]) / (p.z[j + 1] - p.z[j]);
  return f;
}

// Moves to the neighbouring facet when a parameter exceeds the facet by more than `overlap`; false
// when none does.
inline bool change_facet(const Patch& p, FootPoint& f, double overlap) {
  if (f.eta > 1 + overlap && f.i < p.n_s - 1) {
    f.eta = std::min(1.0, (f.eta - 1) * (p.s[f.i + 1] - p.s[f.i]) / (p.s[f.i + 2] - p.s[f.i + 1]));
    ++f.i;
  } else if (f.eta < -overlap && f.i > 0) {
    f.eta = std::max(0.0, 1 + f.eta * (p.s[f.i + 1] - p.s[f.i]) / (p.s[f.i] - p.s[f.i - 1]));
    --f.i;
  } else if (f.zeta > 1 + overlap && f.j < p.n_z - 1) {
    f.zeta =
        std::min(1.0, (f.zeta - 1) * (p.z[f.j + 1] - p.z[f.j]) / (p.z[f.j + 2] - p.z[f.j + 1]));
    ++f.j;
  } else if (f.zeta < -overlap && f.j > 0) {
    f.zeta = std::max(0.0, 1 + f.zeta * (p.z[f.j + 1] - p.z[f.j]) / (p.z[f.j] - p.z[f.j - 1]));
    --f.j;
  } else {
    return false;
  }
  return true;
}

// Orthogonal projection of a point onto a patch by Newton's method for the squared distance. Not
// found: the point lies beside the flank, by more than `beyond` facets.
inline FootPoint project(const Patch& p, const double* u, const Vec3& xs, double beyond) {
  const auto lost = [&](double t) { return t < -kGivenUp - beyond || t > 1 + kGivenUp + beyond; };
  FootPoint f = nearest_node(p, u, xs);
  if (lost(f.zeta)) return f;
  int changes = 0;
  for (int it = 0; it < kMostSteps; ++it) {
    evaluate(p, u, f);
    const Vec3 dist = xs - f.x;
    const Vec2 r(dist.dot(f.x_eta), dist.dot(f.x_zeta));
    Mat2 metric, h;
    metric << f.x_eta.dot(f.x_eta), f.x_eta.dot(f.x_zeta), f.x_eta.dot(f.x_zeta),
        f.x_zeta.dot(f.x_zeta);
    h = metric;
    h(0, 0) -= dist.dot(f.x_etaeta);
    h(0, 1) -= dist.dot(f.x_etazeta);
    h(1, 0) = h(0, 1);
    if (h(0, 0) < kConvex * metric(0, 0) || h.determinant() < kConvex * metric.determinant())
      h = metric;
    Vec2 step = h.inverse() * r;
    const double big = std::max(std::abs(step[0]), std::abs(step[1]));
    if (big > kLongestStep) step /= big;
    f.eta += step[0];
    f.zeta += step[1];
    if (change_facet(p, f, changes < kMostChanges ? kBorder : kOverlap)) {
      ++changes;
    } else if (big < kLastStep) {
      f.found = true;
      break;
    }
    if (lost(f.eta) || lost(f.zeta)) return f;
  }
  const auto within = [&](double t, int facet, int count) {
    return t >= (facet == 0 ? -beyond : -kOverlap) &&
           t <= 1 + (facet == count - 1 ? beyond : kOverlap);
  };
  f.found = f.found && within(f.eta, f.i, p.n_s) && within(f.zeta, f.j, p.n_z);
  if (!f.found) return f;
  evaluate(p, u, f);
  f.normal = p.orientation * f.x_eta.cross(f.x_zeta).normalized();
  f.gap = f.normal.dot(xs - f.x);
  return f;
}

// Adds w (stiffness dg dg^T - pressure d2g) to the blocked rows; nodes: 4 slave, then 4 master.
// With tau_a = x_a . (dx_s - dx_m), P_a = n . dx_m,a, A = x_a . x_b, B = n . x_ab, H = A - g B:
//   d2g = -tau A^-1 B H^-1 tau - tau H^-1 P - P H^-1 tau - g P H^-1 P.
inline int add_contact_tangent(const FootPoint& f, const double* shape, const std::int32_t* conn,
                               const std::uint8_t* sixths, double weight, double stiffness,
                               double pressure, const BlockRows& rows) {
  const double e = f.eta, q = f.zeta;
  const double m[4] = {(1 - e) * (1 - q), e * (1 - q), (1 - e) * q, e * q};
  const double me[4] = {-(1 - q), 1 - q, -q, q}, mz[4] = {-(1 - e), -e, 1 - e, e};
  double c[8], d[8][2];
  for (int a = 0; a < 4; ++a) {
    c[a] = shape[a];
    d[a][0] = d[a][1] = 0;
    c[4 + a] = -m[a];
    d[4 + a][0] = me[a];
    d[4 + a][1] = mz[a];
  }
  Mat2 metric, b, h;
  metric << f.x_eta.dot(f.x_eta), f.x_eta.dot(f.x_zeta), f.x_eta.dot(f.x_zeta),
      f.x_zeta.dot(f.x_zeta);
  b << f.normal.dot(f.x_etaeta), f.normal.dot(f.x_etazeta), f.normal.dot(f.x_etazeta), 0;
  h = (metric - f.gap * b).inverse();
  const Mat2 w = metric.inverse() * b * h;
  Eigen::Matrix<double, 3, 2> x;
  x << f.x_eta, f.x_zeta;
  const Mat3 nn = f.normal * f.normal.transpose();
  const Mat3 curved = stiffness * nn + pressure * (x * w * x.transpose());
  const Eigen::Matrix<double, 3, 2> xh = x * h;  // column b: sum_a x_a H^-1_ab
  int missing = 0;
  for (int k = 0; k < 8; ++k) {
    if (conn[k] < 0 || conn[k] >= rows.n_own) continue;
    for (int l = 0; l < 8; ++l) {
      if (conn[l] < 0) continue;
      Mat3 block = c[k] * c[l] * curved;
      const Vec3 right = xh * Vec2(d[l][0], d[l][1]), left = xh * Vec2(d[k][0], d[k][1]);
      block +=
          pressure * (c[k] * right * f.normal.transpose() + c[l] * f.normal * left.transpose());
      const double pp = Vec2(d[k][0], d[k][1]).dot(h * Vec2(d[l][0], d[l][1]));
      block += pressure * f.gap * pp * nn;
      if (!rows.add(conn[k], sixths[k], conn[l], sixths[l], weight * block)) ++missing;
    }
  }
  return missing;
}

}  // namespace swgpar
