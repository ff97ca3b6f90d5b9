def evaluate(tools, folder, recipes):
    return {}
def print_tables(results):
    pass
