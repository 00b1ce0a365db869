def answer(table):
    return ""
