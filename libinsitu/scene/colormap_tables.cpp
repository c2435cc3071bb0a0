// The colours of the built-in maps.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "scene/colormap.h"
#include "scene/srgb.h"

namespace insitu {
namespace {

using Rgb = std::array<double, 3>;  // sRGB 0..1

// Every fifth of the 256 colours of "viridis" by Nathaniel Smith, Stefan van der Walt and Eric Firing, who gave it to
// the public domain (CC0). What lies between comes within 0.7 of 255 of theirs.
constexpr std::array<Rgb, 52> viridis{{
    {0.2670, 0.0049, 0.3294}, {0.2738, 0.0315, 0.3589}, {0.2788, 0.0621, 0.3866}, {0.2819, 0.0897, 0.4124},
    {0.2832, 0.1157, 0.4361}, {0.2826, 0.1409, 0.4575}, {0.2803, 0.1657, 0.4765}, {0.2762, 0.1901, 0.4930},
    {0.2706, 0.2141, 0.5071}, {0.2637, 0.2376, 0.5188}, {0.2556, 0.2607, 0.5283}, {0.2468, 0.2832, 0.5359},
    {0.2374, 0.3052, 0.5419}, {0.2278, 0.3266, 0.5465}, {0.2181, 0.3474, 0.5500}, {0.2086, 0.3678, 0.5527},
    {0.1994, 0.3876, 0.5546}, {0.1906, 0.4071, 0.5561}, {0.1823, 0.4262, 0.5571}, {0.1743, 0.4450, 0.5578},
    {0.1666, 0.4637, 0.5581}, {0.1592, 0.4822, 0.5581}, {0.1519, 0.5007, 0.5576}, {0.1448, 0.5191, 0.5566},
    {0.1378, 0.5375, 0.5549}, {0.1312, 0.5559, 0.5525}, {0.1254, 0.5743, 0.5491}, {0.1211, 0.5927, 0.5446},
    {0.1194, 0.6111, 0.5390}, {0.1214, 0.6295, 0.5320}, {0.1281, 0.6477, 0.5235}, {0.1402, 0.6659, 0.5134},
    {0.1579, 0.6838, 0.5017}, {0.1807, 0.7014, 0.4882}, {0.2080, 0.7187, 0.4729}, {0.2394, 0.7356, 0.4557},
    {0.2741, 0.7520, 0.4366}, {0.3119, 0.7678, 0.4156}, {0.3524, 0.7830, 0.3926}, {0.3952, 0.7975, 0.3678},
    {0.4401, 0.8111, 0.3410}, {0.4870, 0.8239, 0.3123}, {0.5356, 0.8358, 0.2819}, {0.5857, 0.8467, 0.2499},
    {0.6369, 0.8565, 0.2166}, {0.6889, 0.8654, 0.1827}, {0.7414, 0.8734, 0.1496}, {0.7938, 0.8807, 0.1200},
    {0.8456, 0.8873, 0.0997}, {0.8963, 0.8936, 0.0963}, {0.9456, 0.8998, 0.1128}, {0.9932, 0.9062, 0.1439},
}};

// Likewise "inferno" of the same authors, within 0.8 of 255.
constexpr std::array<Rgb, 52> inferno{{
    {0.0015, 0.0005, 0.0139}, {0.0077, 0.0061, 0.0468}, {0.0194, 0.0151, 0.0888}, {0.0377, 0.0259, 0.1322},
    {0.0613, 0.0366, 0.1776}, {0.0874, 0.0446, 0.2248}, {0.1167, 0.0476, 0.2723}, {0.1491, 0.0455, 0.3171},
    {0.1834, 0.0403, 0.3550}, {0.2179, 0.0366, 0.3835}, {0.2516, 0.0377, 0.4034}, {0.2843, 0.0439, 0.4166},
    {0.3163, 0.0535, 0.4251}, {0.3478, 0.0646, 0.4302}, {0.3790, 0.0763, 0.4327}, {0.4101, 0.0879, 0.4331},
    {0.4412, 0.0993, 0.4316}, {0.4723, 0.1105, 0.4283}, {0.5035, 0.1216, 0.4234}, {0.5347, 0.1325, 0.4167},
    {0.5659, 0.1436, 0.4083}, {0.5969, 0.1548, 0.3981}, {0.6278, 0.1666, 0.3863}, {0.6585, 0.1790, 0.3727},
    {0.6887, 0.1922, 0.3576}, {0.7183, 0.2066, 0.3409}, {0.7471, 0.2224, 0.3229}, {0.7751, 0.2397, 0.3035},
    {0.8019, 0.2587, 0.2831}, {0.8274, 0.2795, 0.2617}, {0.8514, 0.3023, 0.2396}, {0.8737, 0.3269, 0.2169},
    {0.8943, 0.3534, 0.1936}, {0.9130, 0.3816, 0.1698}, {0.9296, 0.4115, 0.1454}, {0.9443, 0.4428, 0.1204},
    {0.9569, 0.4754, 0.0947}, {0.9673, 0.5091, 0.0687}, {0.9757, 0.5438, 0.0436}, {0.9819, 0.5794, 0.0262},
    {0.9860, 0.6158, 0.0256}, {0.9878, 0.6528, 0.0456}, {0.9875, 0.6904, 0.0800}, {0.9849, 0.7284, 0.1208},
    {0.9800, 0.7668, 0.1664}, {0.9731, 0.8054, 0.2169}, {0.9644, 0.8438, 0.2734}, {0.9550, 0.8816, 0.3375},
    {0.9476, 0.9174, 0.4107}, {0.9479, 0.9493, 0.4914}, {0.9618, 0.9759, 0.5719}, {0.9884, 0.9984, 0.6449},
}};

// Colours that stay apart for people who see red and green alike: seven of Okabe and Ito (2008), without black and with
// blue first, then wine and indigo of Tol (2021) and a grey.
constexpr std::array<uint32_t, 10> categorical{0x0072b2, 0xe69f00, 0x009e73, 0xcc79a7, 0x56b4e9,
                                               0xd55e00, 0xf0e442, 0x882255, 0x332288, 0xbbbbbb};

// Place = atomic number, place 0 = unknown. Hues follow the convention of the CPK models for the common elements;
// elsewhere a family of the periodic table has one hue that darkens or turns from light to heavy.
constexpr std::array<uint32_t, 119> elements{
    0xd8a0c0,                                                              // unknown
    0xf2f2f2, 0xd6fafa,                                                    // H He
    0xc77cf2, 0xbceb1e, 0xf5b3ae, 0x858585, 0x3457f0, 0xf01a1a, 0x8edb52,  // Li Be B C N O F
    0xb2e2f2, 0xa85fe8, 0x86e01a, 0xbfa5a0, 0xeec89e, 0xff8a0a, 0xf7e02b,  // Ne Na Mg Al Si P S
    0x2fe32f, 0x82d0e2, 0x8c44d4, 0x4fd61f, 0xe2e2e2, 0xbcc0c6, 0xa4a8b0,  // Cl Ar K Ca Sc Ti V
    0x8c98c4, 0x9a7cc6, 0xde6733, 0xee8fa0, 0x52ce52, 0xc78036, 0x7c80ae,  // Cr Mn Fe Co Ni Cu Zn
    0xc08f8b, 0x6e9090, 0xb884dc, 0xf5a011, 0xa32c26, 0x5db8d0, 0x7030b5,  // Ga Ge As Se Br Kr Rb
    0x22c23a, 0x96f4f2, 0x95dede, 0x74c0c6, 0x56b3b4, 0x3d9d9d, 0x268e8e,  // Sr Y Zr Nb Mo Tc Ru
    0x0c7c8a, 0x08697f, 0xc3c3c3, 0xf9d68e, 0xa7766f, 0x6c8585, 0x9a68b0,  // Rh Pd Ag Cd In Sn Sb
    0xd27d10, 0x8e0e92, 0x439db4, 0x5a1c98, 0x14a030, 0x73d0f8, 0xf6f6c4,  // Te I Xe Cs Ba La Ce
    0xd7f5c5, 0xc5f4c6, 0xa4f4c6, 0x8ef5c6, 0x66f5c6, 0x49f3c6, 0x36f0c6,  // Pr Nd Pm Sm Eu Gd Tb
    0x24eec6, 0x0aed9b, 0x08dd74, 0x08cb54, 0x08b73a, 0x08a426, 0x4fc0f5,  // Dy Ho Er Tm Yb Lu Hf
    0x4fa5f2, 0x2494d4, 0x2a7da8, 0x286694, 0x1a5486, 0xd1d1dd, 0xfad028,  // Ta W Re Os Ir Pt Au
    0xb5b5cd, 0xa5564b, 0x585e66, 0x9552af, 0xa9600c, 0x74504a, 0x43829a,  // Hg Tl Pb Bi Po At Rn
    0x450a7a, 0x0c7a26, 0x70aaf5, 0x0ab8f6, 0x08a0f6, 0x088ef2, 0x0880ec,  // Fr Ra Ac Th Pa U Np
    0x0a6ceb, 0x545cec, 0x785cdd, 0x8a50dd, 0xa037ce, 0xae22ce, 0xae22b5,  // Pu Am Cm Bk Cf Es Fm
    0xae10a2, 0xb80f86, 0xc20466, 0xc80a5a, 0xcc1250, 0xd21c48, 0xd82842,  // Md No Lr Rf Db Sg Bh
    0xde343c, 0xe44038, 0xe84c36, 0xea5634, 0xec6034, 0x8c3c33, 0x4a4f57,  // Hs Mt Ds Rg Cn Nh Fl
    0x7c3f96, 0x8c4c08, 0x5e3e3a, 0x356a80,                                // Mc Lv Ts Og
};

// "coolwarm": the diverging map from blue to red of K. Moreland, Diverging Color Maps for Scientific Visualization,
// 2009.
//
// Msh is CIELAB in polar form: M = |(L, a, b)|, s = angle from the L axis (saturation), h = angle in the a-b plane.
// Each half of the map is a straight line in Msh from an end colour to an unsaturated middle of M = 88, M being at
// least that of the ends. A hue is meaningless in the middle; it is chosen so that the colour changes at an even rate
// (section 4 of the paper): off the end's hue by s sqrt(M_mid^2 - M^2) / (M sin s).
struct Msh {
  double m, s, h;
};

constexpr Rgb white{0.95047, 1.0, 1.08883};  // D65, XYZ

// CIELAB's cube root with its straight piece near 0, and the way back.
double lab_root(double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; }
double lab_cube(double t) { return t > 6.0 / 29.0 ? t * t * t : (116.0 * t - 16.0) * 27.0 / 24389.0; }

Msh msh_of(const Rgb& srgb) {
  const double r = linear_of_srgb(srgb[0]), g = linear_of_srgb(srgb[1]), b = linear_of_srgb(srgb[2]);
  const double x = lab_root((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / white[0]);
  const double y = lab_root((0.2126729 * r + 0.7151522 * g + 0.0721750 * b) / white[1]);
  const double z = lab_root((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / white[2]);
  const double lab_l = 116.0 * y - 16.0, lab_a = 500.0 * (x - y), lab_b = 200.0 * (y - z);
  const double m = std::sqrt(lab_l * lab_l + lab_a * lab_a + lab_b * lab_b);
  return {m, std::acos(lab_l / m), std::atan2(lab_b, lab_a)};
}

Rgb srgb_of(const Msh& color) {
  const double lab_l = color.m * std::cos(color.s);
  const double lab_a = color.m * std::sin(color.s) * std::cos(color.h);
  const double lab_b = color.m * std::sin(color.s) * std::sin(color.h);
  const double y_root = (lab_l + 16.0) / 116.0;
  const double x = white[0] * lab_cube(y_root + lab_a / 500.0);
  const double y = white[1] * lab_cube(y_root);
  const double z = white[2] * lab_cube(y_root - lab_b / 200.0);
  return {srgb_of_linear(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
          srgb_of_linear(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
          srgb_of_linear(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

// The unsaturated middle as seen from the colour `end`.
Msh middle_from(const Msh& end, double m) {
  if (end.m >= m) return {m, 0.0, end.h};
  const double spin = end.s * std::sqrt(m * m - end.m * end.m) / (end.m * std::sin(end.s));
  return {m, 0.0, end.h > -std::numbers::pi / 3 ? end.h + spin : end.h - spin};
}

std::array<Rgb, 257> coolwarm() {
  const std::array<Msh, 2> ends{msh_of({59 / 255.0, 76 / 255.0, 192 / 255.0}),
                                msh_of({180 / 255.0, 4 / 255.0, 38 / 255.0})};
  const double m = std::max({ends[0].m, ends[1].m, 88.0});
  const std::array<Msh, 2> middles{middle_from(ends[0], m), middle_from(ends[1], m)};
  std::array<Rgb, 257> colors;
  for (size_t i = 0; i < colors.size(); ++i) {
    const size_t half = i <= 128 ? 0 : 1;
    const double t = std::abs(static_cast<double>(i) - 128.0) / 128.0;  // 0 in the middle, 1 at the end
    const Msh& from = middles[half];
    const Msh& to = ends[half];
    const auto between = [t](double a, double b) { return (1.0 - t) * a + t * b; };
    colors[i] = srgb_of({between(from.m, to.m), between(from.s, to.s), between(from.h, to.h)});
  }
  return colors;
}

Colormap continuous(std::span<const Rgb> colors) {
  std::vector<double> rgba;
  for (const Rgb& color : colors) rgba.insert(rgba.end(), {color[0], color[1], color[2], 1.0});
  return Colormap::from_srgb(ColormapKind::continuous, rgba);
}

Colormap numbered(std::span<const uint32_t> colors) {
  std::vector<double> rgba;
  for (const uint32_t color : colors) {
    for (const int shift : {16, 8, 0}) rgba.push_back(((color >> shift) & 0xff) / 255.0);
    rgba.push_back(1.0);
  }
  return Colormap::from_srgb(ColormapKind::categorical, rgba);
}

}  // namespace

const std::vector<std::string>& builtin_colormap_names() {
  static const std::vector<std::string> names{"viridis", "inferno", "coolwarm", "categorical", "elements"};
  return names;
}

const Colormap* builtin_colormap(std::string_view name) {
  static const std::array<Colormap, 5> maps{continuous(viridis), continuous(inferno), continuous(coolwarm()),
                                            numbered(categorical), numbered(elements)};  // in the order of the names
  const std::vector<std::string>& names = builtin_colormap_names();
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return &maps[i];
  }
  return nullptr;
}

}  // namespace insitu
