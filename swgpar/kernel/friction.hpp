// Coulomb friction at one quadrature point of two flanks: return mapping and its consistent
// tangent.
//
// Everything is measured in the master's own coordinates (s, z), arc length and width of its
// undeformed flank, with the current base vectors a_s, a_z at the foot point: a rigid rotation of
// both bodies changes nothing. The traction is T = t^s a_s + t^z a_z. With xi the foot point now
// and xi_n, T_n those of the same slave point in the last converged state,
//
//   T_trial = (t_n + eps phi (xi - xi_n))^a a_a,    T = T_trial min(1, mu p / |T_trial|),
//
// with the tangential stiffness eps, MPa / mm. phi is the part of the increment in which the point
// touches: 1 where it did before, else the gap closes in proportion to the increment and phi = d /
// (g_n + d), d = p / eps the depth that carries p. Virtual work T . a_a dxi^a: forces and moments
// of both bodies balance, and the work is that of T along the path of the foot point also where the
// quadrature point lies below the exact surface.
#pragma once

#include "contact.hpp"

namespace swgpar {

struct Friction {  // of all quadrature points; coefficient 0: off
  double coefficient = 0.0;
  const double* stiffness = nullptr;   // (n_face, n_q) eps
  const double* foot_point = nullptr;  // (n_face, n_q, 2) xi_n, nan where there was none
  const double* gap = nullptr;         // (n_face, n_q) g_n
  const double* traction = nullptr;    // (n_face, n_q, 2) t_n
  double* current = nullptr;           // (n_face, n_q, 2) t
  const double* lagged =
      nullptr;  // (n_face, n_q) pressure that stands for p in the law; null: p itself
};

using Mat32 = Eigen::Matrix<double, 3, 2>;
using Mat3x24 = Eigen::Matrix<double, 3, 24>;
using Mat2x24 = Eigen::Matrix<double, 2, 24>;
using Mat24x24 = Eigen::Matrix<double, 24, 24>;

// Traction at a foot point, and what its variation needs; components are those of the facet's (eta,
// zeta).
struct Traction {
  Vec3 value = Vec3::Zero(), trial = Vec3::Zero();
  Vec2 slip = Vec2::Zero();         // xi - xi_n
  Vec2 coefficient = Vec2::Zero();  // T_trial = coefficient_a x_a
  double stiffness = 0.0, phi = 0.0, phi_p = 0.0;
  bool acts = false, slips = false;  // a point without xi_n carries none in this increment
};

inline Traction traction(const FootPoint& f, const Vec2& length, const Vec2& xi,
                         const Friction& law, std::int64_t kq, double pressure) {
  Traction t;
  const Vec2 before(law.foot_point[2 * kq], law.foot_point[2 * kq + 1]);
  if (!(before[0] == before[0])) return t;
  t.acts = true;
  t.stiffness = law.stiffness[kq];
  const double gap = std::max(0.0, law.gap[kq]), depth = pressure / t.stiffness;
  t.phi = depth / (gap + depth);
  t.phi_p = gap / ((gap + depth) * (gap + depth) * t.stiffness);
  t.slip = (xi - before).cwiseQuotient(length);
  const Vec2 old(law.traction[2 * kq], law.traction[2 * kq + 1]);
  t.coefficient = old.cwiseQuotient(length) + t.stiffness * t.phi * t.slip;
  t.trial = t.coefficient[0] * f.x_eta + t.coefficient[1] * f.x_zeta;
  const double size = t.trial.norm(), limit = law.coefficient * pressure;
  t.slips = size > limit;
  const double share = t.slips ? limit / size : 1.0;
  t.value = share * t.trial;
  law.current[2 * kq] = share * t.coefficient[0] * length[0];
  law.current[2 * kq + 1] = share * t.coefficient[1] * length[1];
  return t;
}

// Variation of the foot point with the nodes, and the tangential forces on these; nodes: 4 slave,
// then 4 master.
struct Motion {
  Mat3x24 relative, u_eta, u_zeta,
      u_mixed;  // x_slave - x_master(foot) and the master's derivatives, per nodal motion
  Mat32 x;
  Mat2 inverse;         // of H = A - g B
  Mat2x24 drive, foot;  // x_a . relative + g n . u_a, and H^-1 of it: the motion of the foot point

  Motion(const FootPoint& f, const double* shape) {
    const double e = f.eta, q = f.zeta;
    const double m[4] = {(1 - e) * (1 - q), e * (1 - q), (1 - e) * q, e * q};
    const double me[4] = {-(1 - q), 1 - q, -q, q}, mz[4] = {-(1 - e), -e, 1 - e, e},
                 mixed[4] = {1, -1, -1, 1};
    u_eta.setZero(), u_zeta.setZero(), u_mixed.setZero();
    for (int a = 0; a < 4; ++a) {
      relative.middleCols<3>(3 * a) = shape[a] * Mat3::Identity();
      relative.middleCols<3>(12 + 3 * a) = -m[a] * Mat3::Identity();
      u_eta.middleCols<3>(12 + 3 * a) = me[a] * Mat3::Identity();
      u_zeta.middleCols<3>(12 + 3 * a) = mz[a] * Mat3::Identity();
      u_mixed.middleCols<3>(12 + 3 * a) = mixed[a] * Mat3::Identity();
    }
    x << f.x_eta, f.x_zeta;
    Mat2 curvature;
    curvature << f.normal.dot(f.x_etaeta), f.normal.dot(f.x_etazeta), f.normal.dot(f.x_etazeta), 0;
    inverse = (x.transpose() * x - f.gap * curvature).inverse();
    drive << f.x_eta.transpose() * relative + f.gap * f.normal.transpose() * u_eta,
        f.x_zeta.transpose() * relative + f.gap * f.normal.transpose() * u_zeta;
    foot = inverse * drive;
  }

  // Motion of the foot point by the rotation of the master body: the curve's height over its chord
  // rotates, nodes do not.
  Vec2 by_rotation(const FootPoint& f) const {
    const Vec3 height_rate(-f.height[1], f.height[0], 0),
        height_rate_eta(-f.height_eta[1], f.height_eta[0], 0);
    return inverse * Vec2(f.gap * f.normal.dot(height_rate_eta) - f.x_eta.dot(height_rate),
                          -f.x_zeta.dot(height_rate));
  }
};

// Derivative of the traction by the pressure that bounds it.
inline Vec3 by_pressure(const Traction& t, const Motion& v, const Friction& law) {
  const Vec3 trial = t.stiffness * t.phi_p * (v.x * t.slip);
  if (!t.slips) return trial;
  const double size = t.trial.norm();
  const Vec3 along = t.trial / size;
  const double share = t.value.norm() / size;
  return law.coefficient * along + share * (trial - along.dot(trial) * along);
}

// Adds w times the derivative of the nodal forces T . x_a foot_a. `share` bounds the geometric
// terms as the pressure's limit does those of the normal force. third : third derivative of the
// master's profile
inline int add_friction_tangent(const FootPoint& f, const Traction& t, const Motion& v,
                                const Vec3& third, const std::int32_t* conn,
                                const std::uint8_t* sixths, double weight, double penalty,
                                double pressure, double share, const Friction& law,
                                const BlockRows& rows) {
  using Row = Eigen::Matrix<double, 1, 24>;
  const Vec3& n = f.normal;
  const Row dg = n.transpose() * v.relative;
  const Row dp = law.lagged == nullptr ? Row(-penalty * dg) : Row::Zero();
  const Mat3x24 d_eta = v.u_eta + f.x_etaeta * v.foot.row(0) + f.x_etazeta * v.foot.row(1);
  const Mat3x24 d_zeta = v.u_zeta + f.x_etazeta * v.foot.row(0);
  Mat3x24 dt = t.stiffness * (t.phi * v.x * v.foot + t.phi_p * (v.x * t.slip).eval() * dp);
  dt += t.coefficient[0] * d_eta + t.coefficient[1] * d_zeta;
  if (t.slips) {
    const double size = t.trial.norm();
    const Vec3 along = t.trial / size;
    const Mat3 across = Mat3::Identity() - along * along.transpose();
    dt = (law.coefficient * (along * dp + pressure / size * across * dt)).eval();
  }
  // y = H^-1 (x . T): the forces are y_a drive_a
  const Vec2 y = v.inverse * (v.x.transpose() * t.value);
  Mat2x24 lift;
  lift << n.transpose() * d_eta, n.transpose() * d_zeta;
  const Mat3x24 dn = -(v.x * (v.x.transpose() * v.x).inverse()) * lift;
  const Row b_ee = f.x_etaeta.transpose() * dn + n.dot(third) * v.foot.row(0);
  const Row b_ez = f.x_etazeta.transpose() * dn + n.transpose() * v.u_mixed;
  const Row h_ee = 2.0 * f.x_eta.transpose() * d_eta - n.dot(f.x_etaeta) * dg - f.gap * b_ee;
  const Row h_ez = f.x_zeta.transpose() * d_eta + f.x_eta.transpose() * d_zeta -
                   n.dot(f.x_etazeta) * dg - f.gap * b_ez;
  const Row h_zz = 2.0 * f.x_zeta.transpose() * d_zeta;
  Mat2x24 dy = v.x.transpose() * dt;
  dy.row(0) += t.value.transpose() * d_eta - y[0] * h_ee - y[1] * h_ez;
  dy.row(1) += t.value.transpose() * d_zeta - y[0] * h_ez - y[1] * h_zz;
  dy = (v.inverse * dy).eval();
  const Vec3 force = v.x * y;
  Mat24x24 k = v.relative.transpose() * (y[0] * d_eta + y[1] * d_zeta);
  k -= v.u_eta.transpose() * force * v.foot.row(0) + v.u_zeta.transpose() * force * v.foot.row(1);
  const Mat3x24 gap_vector = n * dg + f.gap * dn;
  k += y[0] * v.u_eta.transpose() * gap_vector + y[1] * v.u_zeta.transpose() * gap_vector;
  const Row crossed = f.gap * (y[0] * v.foot.row(1) + y[1] * v.foot.row(0));
  k += v.u_mixed.transpose() * n * crossed;
  k = (share * k + v.drive.transpose() * dy).eval();
  int missing = 0;
  for (int a = 0; a < 8; ++a) {
    if (conn[a] < 0 || conn[a] >= rows.n_own) continue;
    for (int b = 0; b < 8; ++b)
      if (conn[b] >= 0 &&
          !rows.add(conn[a], sixths[a], conn[b], sixths[b], weight * k.block<3, 3>(3 * a, 3 * b)))
        ++missing;
  }
  return missing;
}

}  // namespace swgpar
