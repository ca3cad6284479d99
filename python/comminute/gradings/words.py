# ruff: noqa: E501, RUF001  (a table of words; and the signs that look alike are its subject)
"""The words by which laboratories name what a sieve table holds, and what a header of such words means.

`HEADER_WORDS` and `ROW_WORDS` are the one place where a word is known: a new word, or a language, is added there, and
`docs/sieve_tables.md` is written from them by `docs/sieve_tables.py`.
"""

from __future__ import annotations

import functools
import re
import unicodedata

HEADER_WORDS: dict[str, dict[str, str]] = {
    "size": {
        "English": "size, sieve, sieves, opening, aperture, diameter, screen, dia, grainsize, particle, grain, d, grat size",
        "German": "grosse, siebe, korngrosse, korngroesse, korn, siebweite, maschenweite, lochweite, sieb, siebgrosse, sieboffnung, "
        "siebnennweite, durchmesser, korndurchmesser, teilchengrosse, partikelgrosse, kornklasse, fraktion, offnungsweite, "
        "nennoffnungsweite, siebmaschenweite",
        "French": "tamis, ouverture, maille, mailles, diametre, taille, dimension, calibre",
        "Spanish": "tamiz, malla, abertura, apertura, diametro, tamano, luz",
        "Portuguese": "peneira, peneiras, malha, abertura, diametro, tamanho",
        "Italian": "setaccio, setacci, vaglio, apertura, maglia, diametro, dimensione",
        "Japanese": "粒径, 粒度, ふるい, フルイ, 篩, 目開き, 目の開き, 呼び寸法",
        "Chinese": "粒径, 粒度, 筛孔尺寸, 筛孔, 孔径, 筛子, 筛, 粒级, 直径",
    },
    "phi": {"English": "phi, φ, krumbein"},
    "mesh": {
        "English": "mesh, meshes, sieve no, sieve number, sieve designation, designation, us standard sieve, tyler",
        "German": "siebnummer, sieb nr",
        "French": "tamis no",
        "Spanish": "tamiz no, tamiz numero, numero de tamiz, malla no",
        "Portuguese": "peneira no, numero da peneira",
        "Italian": "setaccio no",
        "Japanese": "メッシュ",
        "Chinese": "目数",
    },
    "finer": {
        "English": "finer, passing, passed, pass, undersize, smaller, less, through, under, below, grat perp, cpft",
        "German": "durchgang, siebdurchgang, feiner, unterkorn, kleiner, durchgange",
        "French": "passant, passants, tamisat, tamisats, passe, inferieur",
        "Spanish": "pasa, pasante, pasan, pasado, mas fino",
        "Portuguese": "passa, passante, passantes, passando",
        "Italian": "passante, passanti, passato",
        "Japanese": "通過, 通過率, ふるい下, 篩下",
        "Chinese": "通过, 通过率, 小于, 筛下",
    },
    "retained": {
        "English": "retained, retain, retaining, ret, residue, held, oversieve",
        "German": "ruckstand, siebruckstand, rueckstand",
        "French": "refus, retenu, retenue",
        "Spanish": "retenido, retenida, retiene",
        "Portuguese": "retido, retida, retidos",
        "Italian": "trattenuto, trattenuta, ritenuto, residuo",
        "Japanese": "残留, 残留率, 残分, ふるい上",
        "Chinese": "筛余, 筛余率, 筛上, 留筛, 残留",
    },
    "coarser": {
        "English": "coarser, oversize, larger, greater",
        "German": "grober, uberkorn",
        "French": "superieur",
        "Chinese": "大于",
    },
    "cumulative": {
        "English": "cumulative, cumulated, cum, cumul, accumulated, accumulative, total, cumulatively",
        "German": "kumuliert, kumulativ, kumulierte, kumulierter, summe, summen, gesamt, summiert",
        "French": "cumule, cumulee, cumules, cumulatif",
        "Spanish": "acumulado, acumulada, acum",
        "Portuguese": "acumulado, acumulada, acum",
        "Italian": "cumulato, cumulata, cumulativo, cumulativa",
        "Japanese": "累加, 累積, 加積, 積算",
        "Chinese": "累计, 累积",
    },
    "each": {
        "English": "individual, each, partial, differential, fractional, frequency, class",
        "German": "einzel, einzelner, anteil, haufigkeit",
        "French": "partiel, partiels",
        "Spanish": "parcial, simple",
        "Portuguese": "parcial, simples",
        "Italian": "parziale",
        "Chinese": "分计, 分级",
    },
    "mass": {
        "English": "mass, weight, wt, masses, weights",
        "German": "masse, massen, gewicht, gew, einwaage, auswaage",
        "French": "masse, poids",
        "Spanish": "masa, peso",
        "Portuguese": "massa, peso",
        "Italian": "massa, peso",
        "Japanese": "質量, 重量",
        "Chinese": "质量, 重量",
    },
    "count": {
        "English": "count, counts, number of grains, number of particles, number, grains counted",
        "German": "anzahl, stuckzahl",
        "French": "nombre",
        "Spanish": "numero de granos, conteo",
        "Portuguese": "contagem, numero de graos",
        "Italian": "conteggio, numero di grani",
        "Japanese": "個数, 粒数",
        "Chinese": "个数, 颗数, 颗粒数",
    },
    "percent": {
        "English": "percent, percentage, pct, per cent, perc",
        "German": "prozent, massenprozent",
        "French": "pourcentage, pour cent, pourcent",
        "Spanish": "porcentaje, por ciento",
        "Portuguese": "porcentagem, percentagem, percentual",
        "Italian": "percentuale, per cento",
        "Japanese": "百分率, 通過率, 残留率, 割合",
        "Chinese": "百分率, 百分数, 百分比, 通过率, 筛余率",
    },
    "fraction": {"English": "fraction, fractions, share, proportion", "German": "massenanteil", "French": "part"},
    "sample": {
        "English": "sample, samples, specimen, sample id, sample no, sample name, borehole, test, test no, "
        "location, depth, run, series, batch, lab no, station, core, hole",
        "German": "probe, proben, bohrung, entnahmestelle, tiefe, versuch, probennummer, labornummer",
        "French": "echantillon, echantillons, sondage, profondeur, essai",
        "Spanish": "muestra, muestras, sondeo, profundidad, ensayo",
        "Portuguese": "amostra, amostras, sondagem, profundidade, ensaio",
        "Italian": "campione, campioni, sondaggio, profondita, prova",
        "Japanese": "試料, 試料番号, 深さ, 地点",
        "Chinese": "样品, 试样, 样号, 编号, 深度",
    },
    "limit": {
        "English": "specification, spec, specs, limit, limits, envelope, requirement, required, tolerance, target, min, max, "
        "minimum, maximum, error, uncertainty, std, sd",
        "German": "grenze, grenzwert, soll, sollwert, untere grenze, obere grenze, toleranz, norm",
        "French": "limite, specification, fuseau",
        "Spanish": "especificacion, limite, requisito",
        "Portuguese": "especificacao, limite",
        "Italian": "limite, specifica, fuso",
        "Japanese": "規格, 基準",
        "Chinese": "规范, 标准要求, 上限, 下限",
    },
    "upper": {
        "English": "upper, from, d max, coarse edge, upper edge, high",
        "German": "von, obere",
        "French": "superieure",
        "Spanish": "desde",
    },
    "lower": {
        "English": "lower, to, d min, fine edge, lower edge, low",
        "German": "bis, untere",
        "French": "inferieure",
        "Spanish": "hasta",
        "Portuguese": "ate",
    },
    "middle": {
        "English": "mid, middle, midpoint, mid point, mean, average, geometric mean",
        "German": "mittel, mittlere, klassenmitte",
        "French": "moyen, moyenne",
        "Spanish": "medio, media",
        "Chinese": "平均",
    },
    "vessel": {
        "English": "tare, gross, empty, container, dish, can, plus",
        "German": "tara, brutto, leer, behalter",
        "French": "tare, brut, vide",
        "Spanish": "tara, bruto, vacio",
        "Portuguese": "tara, bruto, vazia",
        "Italian": "tara, lordo, vuoto",
        "Japanese": "風袋",
        "Chinese": "皮重, 毛重",
    },
}

ROW_WORDS: dict[str, dict[str, str]] = {
    "pan": {
        "English": "pan, bottom, bottom pan, base, receiver, tray, catch pan, collector, fines, base pan, sieve pan",
        "German": "schale, boden, bodenschale, auffangschale, pfanne, siebboden, auffang, siebpfanne",
        "French": "fond, fond de tamis, receveur, bac, recipient, fonds",
        "Spanish": "fondo, bandeja, ciego, recipiente, charola, cazoleta, plato, bandeja fondo",
        "Portuguese": "fundo, prato, bandeja, fundo cego",
        "Italian": "fondo, vaschetta, raccoglitore, fondello",
        "Japanese": "受皿, 受け皿, 皿, 受器, パン",
        "Chinese": "底盘, 筛底, 底, 盘",
    },
    "washed": {
        "English": "washed, wash, washed through, washings, washed out, wash fines, wash water",
        "German": "abgeschlammt, abgeschlammtes, ausgewaschen, abschlammbares",
        "French": "lave, lavage",
        "Spanish": "lavado",
        "Portuguese": "lavado, lavagem",
        "Italian": "lavato, lavaggio",
    },
    "total": {
        "English": "total, sum, totals, sum total, total mass, total weight, total retained",
        "German": "summe, gesamt, gesamtmasse, insgesamt",
        "French": "total, somme, totaux, masse totale",
        "Spanish": "total, suma, sumatoria, totales, masa total, peso total",
        "Portuguese": "total, soma, somatorio, massa total",
        "Italian": "totale, somma",
        "Japanese": "合計, 計, 総計",
        "Chinese": "合计, 总计, 总和, 总质量",
    },
    "initial": {
        "English": "initial mass, initial weight, dry mass, dry weight, sample mass, sample weight, initial dry mass, "
        "initial dry weight, mass before, total dry mass, total dry weight, mass of sample, original mass, oven dry mass",
        "German": "einwaage, trockenmasse, probenmasse",
        "French": "masse initiale, masse seche",
        "Spanish": "masa inicial, peso inicial, peso seco, masa seca",
        "Portuguese": "massa inicial, peso inicial, massa seca",
        "Italian": "massa iniziale, peso iniziale",
        "Japanese": "全質量",
        "Chinese": "试样总质量",
    },
    "loss": {
        "English": "loss, losses, lost, sieve loss, sieving loss, mass loss, error, difference",
        "German": "verlust, siebverlust, verluste, differenz",
        "French": "perte, pertes",
        "Spanish": "perdida, perdidas",
        "Portuguese": "perda, perdas",
        "Italian": "perdita, perdite",
        "Japanese": "損失",
        "Chinese": "损失, 散失",
    },
    "signature": {
        "English": "tested by, checked by, approved by, reported by, reviewed by, performed by, sampled by, signature, date, "
        "test date, remark, remarks, note, notes, operator, technician, laboratory, engineer, method, standard",
        "German": "gepruft, bearbeiter, bearbeitet, datum, bemerkung, bemerkungen, unterschrift, labor, laborant",
        "French": "date, operateur, remarque, remarques, laboratoire, verifie par",
        "Spanish": "fecha, realizado por, revisado por, observaciones, laboratorio, ensayado por",
        "Portuguese": "data, realizado por, verificado por, observacoes, laboratorio",
        "Italian": "data, eseguito da, verificato da, note, laboratorio",
        "Japanese": "試験者, 日付, 備考, 試験日",
        "Chinese": "试验, 复核, 审核, 日期, 备注",
    },
    "summary": {
        "English": "fineness modulus, fm, cu, cc, d10, d15, d16, d20, d30, d50, d60, d80, d84, d85, d90, d95, f80, p80, "
        "coefficient of uniformity, coefficient of curvature, moisture, water content, gs, "
        "effective size, uniformity coefficient, median",
        "German": "feinheitsmodul, ungleichformigkeitszahl, krummungszahl, wassergehalt, koernungsziffer",
        "French": "module de finesse, coefficient d uniformite, teneur en eau, mf",
        "Spanish": "modulo de finura, mf, humedad",
        "Portuguese": "modulo de finura, mf, umidade, dimensao maxima, dmax",
        "Italian": "modulo di finezza, umidita",
        "Japanese": "粗粒率, 均等係数, 曲率係数",
        "Chinese": "细度模数, 不均匀系数, 曲率系数",
    },
}

LENGTHS = {
    "nm": "nm",
    "um": "um",
    "μm": "um",
    "micron": "um",
    "microns": "um",
    "micrometre": "um",
    "micrometres": "um",
    "micrometer": "um",
    "micrometers": "um",
    "mikrometer": "um",
    "mm": "mm",
    "millimetre": "mm",
    "millimetres": "mm",
    "millimeter": "mm",
    "millimeters": "mm",
    "milimetros": "mm",
    "millimetri": "mm",
    "毫米": "mm",
    "微米": "um",
    "cm": "cm",
    "m": "m",
    "in": "in",
    "inch": "in",
    "inches": "in",
    "zoll": "in",
    "pouce": "in",
    "pouces": "in",
    "pulg": "in",
    "pulgada": "in",
    "pulgadas": "in",
    "polegada": "in",
    "polegadas": "in",
    "pollice": "in",
    "pollici": "in",
    '"': "in",
}
GRAMS = {"g": 1.0, "gr": 1.0, "gram": 1.0, "grams": 1.0, "gramm": 1.0, "gm": 1.0, "gms": 1.0, "grammes": 1.0}
GRAMS |= {"gramos": 1.0, "gramas": 1.0, "grammi": 1.0, "克": 1.0, "kg": 1000.0, "kilogram": 1000.0, "mg": 1e-3}
GRAMS |= {"t": 1e6, "lb": 453.59237, "lbs": 453.59237, "oz": 28.349523125}
PERCENTS = frozenset(("%", "percent", "pct", "wt%", "m%", "ma%", "mass%", "vol%"))
NO_UNITS = frozenset(("-", "–", "—", "1", "[-]", "(-)"))
# words that say nothing of a column's meaning
FILLERS = frozenset(
    [
        "by",
        "of",
        "the",
        "on",
        "at",
        "de",
        "que",
        "da",
        "do",
        "des",
        "du",
        "en",
        "and",
        "der",
        "die",
        "im",
        "than",
        "durch",
        "auf",
        "em",
        "al",
        "la",
        "le",
        "el",
        "per",
        "pro",
        "or",
        "volume",
        "vol",
        "dry",
        "grain",
        "in",
        "sample",
        "soil",
        "aggregate",
        "material",
        "trocken",
        "ma",
        "nominal",
        "us",
        "standard",
        "std",
        "astm",
        "iso",
        "din",
        "bs",
        "number",
        "no",
        "nr",
        "q3",
        "と",
        "の",
        "し",
        "た",
        "的",
    ]
)

VULGAR = {"½": "1/2", "¼": "1/4", "¾": "3/4", "⅛": "1/8", "⅜": "3/8", "⅝": "5/8", "⅞": "7/8", "⅓": "1/3", "⅔": "2/3"}
SIGNS = str.maketrans(
    dict.fromkeys("−‐‑‒–—―－", "-")
    | dict.fromkeys("″”“〞＂", '"')
    | dict.fromkeys("’‘′", "'")
    | {"°": "o", "µ": "μ", "〜": "~", "～": "~", "÷": "~"}
)


def plain(text: str) -> str:
    """Text with the signs that have many forms in one: minus, inch marks, full-width letters, vulgar fractions."""
    for sign, digits in VULGAR.items():
        text = re.sub(rf"\s*{sign}", f" {digits}", text) if sign in text else text
    text = text.replace("''", '"').replace("\u2032\u2032", '"').translate(SIGNS)
    return re.sub(r"\s+", " ", unicodedata.normalize("NFKC", text).translate(SIGNS)).strip()


def folded(text: str) -> str:
    """Plain text in small letters without accents, as the tables of words write it."""
    spread = unicodedata.normalize("NFD", plain(text).casefold())
    kept = "".join(c for c in spread if not ("\u0300" <= c <= "\u036f"))
    return unicodedata.normalize("NFC", kept)


@functools.cache
def _phrases(table: str) -> tuple[tuple[str, frozenset[str]], ...]:
    """Words of a table with their meanings, longest first, so that a long one hides the short ones in it."""
    meanings: dict[str, set[str]] = {}
    for meaning, languages in (HEADER_WORDS if table == "header" else ROW_WORDS).items():
        for line in languages.values():
            for word in line.split(", "):
                meanings.setdefault(folded(word), set()).add(meaning)
    ordered = sorted(meanings, key=lambda word: (-len(word), word))
    return tuple((word, frozenset(meanings[word])) for word in ordered)


def meanings_of(text: str, table: str = "header") -> tuple[frozenset[str], list[str]]:
    """Meanings of the words in a text, and the words without one."""
    pieces = re.findall(r"[a-z]+[0-9]*|φ|[0-9]+|[^\W\d_a-zφ]+|[%#]", folded(text))
    left = " " + " ".join("no" if piece == "#" else piece for piece in pieces) + " "
    found: set[str] = set()
    for word, meanings in _phrases(table):
        pattern = f" {word} " if word.isascii() or word == "φ" else word
        if pattern in left:
            found |= meanings
            left = left.replace(pattern, " \x00 ")
    if "%" in pieces:
        found.add("percent")
    rest = [word for word in left.replace("\x00", " ").split() if word not in FILLERS and word != "%"]
    return frozenset(found), rest


def begins_with(words: str, meaning: str) -> bool:
    """Tell whether a folded text begins with a word for the name of a row."""
    return any(
        words.startswith(word) and not words[len(word) : len(word) + 1].isalnum()
        for word, meanings in _phrases("row")
        if meaning in meanings
    )
